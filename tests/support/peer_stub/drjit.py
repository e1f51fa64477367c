"""Stands in for drjit in tests of `abbe study --against mitsuba`."""


def set_thread_count(count):
    pass


def eval(*things):
    pass


def sync_thread():
    pass
