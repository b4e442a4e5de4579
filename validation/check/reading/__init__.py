"""Every source of another model's curves, read to the one form of ``validation/check/curves.py``.

A source becomes a table of columns (``table.py``); its headings are understood (``headings.py``,
``meaning.py``); the table becomes curves or values over speed (``interpretation.py``). ``reader.py`` chooses
by the kind of the source. A description in TOML (``description.py``) states what headings would have to say.
"""
