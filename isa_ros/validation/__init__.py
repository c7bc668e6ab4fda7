"""
`isa validate`: comparison of the shipped actuators with the paper, number by number.

A group of checks is one file with one plain function without arguments that returns
`Findings`: its entries and, optionally, figures. To add one, write the file and add one
line to `groups.GROUPS`. In it:

- Take the paper's value from `isa_ros.paper.printed` (`cell`, `statement`), so that the value
  and its place in the paper are written once; `Entry.of` copies both.
- Take the parameters from the shipped sheets as they are (`sheets.model_sheet`). Nothing is tuned
  per check. What is simulated comes from `actuators.CheckedActuators`, the argument of a group
  that `sensitivity` runs with a parameter changed.
- Say whether an entry's source is the paper, with an interval from the paper's own precision, or
  our own target. An interval never comes from another simulated run. If the printed value lies
  outside of it, `reading` is the erratum of docs/paper-errata.md by which the value is read.
- Give `reason`, the known cause, to a value that is not reached; never widen the interval.

Groups run in two worker processes, so they share no state; a group that runs for more than a
few seconds has ``is_long`` set, and starts first.
"""
