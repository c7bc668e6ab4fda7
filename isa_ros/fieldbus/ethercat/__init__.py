"""EtherCAT slaves in software: frames, registers, state machine, mailbox and process data."""

from isa_ros.fieldbus.ethercat.line import ethercat_line as ethercat_line

__all__ = ['ethercat_line']
