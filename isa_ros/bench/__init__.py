"""
`isa bench`: how fast this machine simulates, what it takes, and what limits it.

A group of rows is one file with one function. It measures in this process, or it names `Spec`s:
whole runs, each in a process of its own, which `rounds` repeats in alternating order so that a
drift of the machine meets all of them alike. Rows are medians beside a floor of the same
call. To add a group, write the file and add one line to `groups.GROUPS`.
"""
