"""The programs: each loads what it runs; a signal meanwhile ends it without a traceback."""
