"""EtherCAT slaves in software: frames, registers, state machine, mailbox and process data."""
