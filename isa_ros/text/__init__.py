"""Text output: tables, progress of long work, and Markdown pages with figures."""
