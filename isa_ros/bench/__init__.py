"""
`isa bench`: speed, memory and start-up of simulations on this machine, and their limits.

A group of rows is one file with one function. It measures in this process, or it lists `Spec`s:
whole runs, each in its own process, which `rounds` repeats in alternating order so that a drift
of the machine affects all of them alike. Rows are medians, compared with a floor (the same work
with the least possible overhead) of the same call. To add a group, write the file and add one
line to `groups.GROUPS`.
"""
