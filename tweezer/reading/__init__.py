"""Tables of positions over time, as programs of measurement write them: text, arrays, HDF5, TDMS.

A file is opened as a `Table` of columns; those that are wanted are chosen by their headings, or by
name (`Reading`), and put into SI units (`read_table`). `without_gaps` is the rule on what lacks.
`__init__.pyi` lists the names. They are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
