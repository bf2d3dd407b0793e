"""Reading of tables of positions over time: text, arrays, HDF5 and TDMS files.

A file is opened as a `Table` of columns. The required columns are chosen by their headings, or by
the user's options (`Reading`), and converted to SI units (`read_table`). `without_gaps` fills or
removes gaps. `__init__.pyi` lists the public names, which are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
