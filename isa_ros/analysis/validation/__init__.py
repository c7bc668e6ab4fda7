"""
`isa validate`: comparison of the shipped actuators with the paper, number by number.

A group of checks is one file with one plain function without arguments that returns
`Findings`: its entries and, optionally, figures. To add one, write the file and add one
line to `groups.GROUPS`. In it:

- Take the paper's value from `isa_ros.paper.printed` (`cell`, `statement`), so that the value
  and its place in the paper are written once; `Entry.of` copies both.
- Take the parameters from the shipped sheets as they are (`sheets.model_sheet`, or a shipped
  run file through `isa_ros.scripting.run.load`). Nothing is tuned per check.
- Give each entry an interval and its source. If the printed value lies outside of it,
  `reading` is the erratum of docs/paper-errata.md by which the value is read.
- Give `reason`, the known cause, to a value that is not reached; never widen the interval.

Groups run in two worker processes, so they share no state; a group that runs for more than a
few seconds has ``is_long`` set, and starts first.
"""
