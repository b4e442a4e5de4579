"""REXS, the Reusable Engineering EXchange Standard of gear units: reading, checking and writing its files.

Facts about the format were taken from its published database of component types, attributes and relations
(versions 1.0 to 1.7 and 2.0.0), its XML schema and its JSON syntax, see ``docs/how_to/rexs.md``.
"""
