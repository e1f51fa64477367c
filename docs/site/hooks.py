"""What mkdocs has to be told of pages that are written to be read in the repository, too."""
import posixpath
import re
from pathlib import Path

_LINK = re.compile(r"\]\(([^)\s:#]+)(#[^)\s]*)?\)")
_FENCE = re.compile(r"^(\s*```kdl) .*$", re.MULTILINE)


def _pages_of(docs, folder):
    pages = sorted(docs.glob(folder + "*.md"), key=lambda page: (page.name != "README.md", page))
    return [page.relative_to(docs).as_posix() for page in pages + sorted(docs.glob(folder + "*/README.md"))]


def _expanded(entries, docs):
    for entry in entries:
        if isinstance(entry, dict):
            title, below = next(iter(entry.items()))
            if isinstance(below, str) and below.endswith("/"):
                below = _pages_of(docs, below)
            elif isinstance(below, list):
                below = list(_expanded(below, docs))
            yield {title: below}
        elif "*" in entry:
            yield from sorted(page.relative_to(docs).as_posix() for page in docs.glob(entry))
        else:
            yield entry


def on_config(config):
    config.nav = list(_expanded(config.nav, Path(config.docs_dir)))
    return config


def on_page_markdown(markdown, page, config, files):
    here = posixpath.dirname(page.file.src_uri)

    def link(match):
        target = posixpath.normpath(posixpath.join(here, match[1]))
        index = posixpath.join(target, "README.md")
        if not files.get_file_from_path(index):
            return match[0]
        return f"]({posixpath.relpath(index, here or '.')}{match[2] or ''})"

    # Links to a folder show its page; the marks of snippets are for the tests.
    return _FENCE.sub(r"\1", _LINK.sub(link, markdown))
