"""What a person reads: tables, the progress of long work, and Markdown pages with figures."""
