"""Numbers with units and errors, their printed form, and safe reading and writing of files."""
