"""Abbe, a spectral film renderer, from Python.

`abbe.usd` reads OpenUSD stages. It needs `usd-core` (`pip install "abbe[usd]"`) and uses the program `abbe` to render only.
"""
