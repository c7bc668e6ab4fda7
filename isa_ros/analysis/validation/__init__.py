"""
`isa validate`: the shipped actuators held against the paper, number by number.

A group of checks is one file with one plain function that takes nothing and returns
`Findings`: its entries and, if it likes, figures. To add one, write the file and add one
line to `groups.GROUPS`; nothing else. In it:

- Take the paper's value from `isa_ros.paper.printed` (`cell`, `statement`), so that what is
  printed and where is written once; `Entry.of` copies both.
- Take the parameters from the shipped sheets as they are (`sheets.model_sheet`, or a shipped
  run file through `isa_ros.analysis.experiment.run`). Nothing is tuned per check.
- Give each entry an interval and say where it comes from. Where the printed value lies
  outside of it, `reading` names the erratum of docs/paper-errata.md it is read by.
- Give `reason`, the known cause, to a value that is not reached; never widen the interval.

Groups run in two worker processes, so they share nothing; a group that runs for more than a
few seconds says so with ``is_long``, and starts first.
"""
