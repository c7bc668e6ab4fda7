"""The command `isa bus`; its modules are imported in the functions, as in `commands`."""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from isa_ros.cli.run_arguments import DESCRIBE
from isa_ros.cli.running import print_line, recorded, simulating
from isa_ros.config.paths import CONFIG, find
from isa_ros.fieldbus.request import BUSES, BusRequest
from isa_ros.run.options import request_of_arguments

if TYPE_CHECKING:
    from isa_ros.run.session import Report


def bus(options: Namespace) -> bool:
    """Run with the master of a bus, or describe the devices of a run."""
    if options.bus == DESCRIBE:
        return describe(options)
    return serve(options)


def bus_request_of(options: Namespace) -> BusRequest:
    """Return the request of the command line."""
    values = vars(options)
    own = {argument.name: values[argument.name] for argument in BUSES[options.bus].arguments}
    return BusRequest(
        run=request_of_arguments(values, in_process=True, is_alone=options.is_alone),
        bus=options.bus, pace=options.pace, profile=options.profile,
        watchdog_ms=options.watchdog_ms, has_ros=not options.no_ros, arguments=own)


@simulating
def serve(options: Namespace) -> bool:
    """Run and record a configuration whose commands come from the master of a bus."""
    from isa_ros.fieldbus.device.devices import devices_of
    from isa_ros.fieldbus.lines import line_of, refuse_unusable
    from isa_ros.fieldbus.session import prepare_bus
    from isa_ros.fieldbus.sole_bus import sole_bus
    request = bus_request_of(options)
    prepared = prepare_bus(request, devices_of, line_of(request), print_line)
    run = prepared.session.run
    session = prepared.session

    def serving(report: 'Report | None') -> None:
        if request.has_ros:
            from isa_ros.nodes.bringup import run_session
            run_session(session, report)
            return
        from isa_ros.processes.stopping import StopRequest
        from isa_ros.run.without_ros import run_without_ros
        with StopRequest() as should_stop:
            run_without_ros(session, report, should_stop)
    with sole_bus(request):
        said = refuse_unusable(request, devices_of(run, request.profile), run.step_ns)
        if said:
            print_line(said)
        try:
            recorded(session, serving)
        finally:
            if prepared.summary is not None:
                print_line(prepared.summary)
    return session.is_as_wanted


def describe(options: Namespace) -> bool:
    """Write the description of the devices for a master."""
    from isa_ros.config.runs.run_file import load_run
    from isa_ros.config.text.changes import values_of
    from isa_ros.fieldbus.description.files import described, FOLDERS, tables_of
    from isa_ros.fieldbus.device.devices import devices_of
    run = load_run(find(options.config, CONFIG), values_of(options.set, '--set'))
    devices = devices_of(run, options.profile)
    if options.table:
        print(tables_of(devices))
        return True
    files = described(devices, options.esi, options.eds)
    for name, files_of in FOLDERS.items():
        directory: Path | None = vars(options)[name]
        if directory is not None:
            files = files_of(devices, run.step_ns, directory)
            directory.mkdir(parents=True, exist_ok=True)
    for path, text in files.items():
        path.write_text(text, encoding='utf-8')
        print(path)
    return True
