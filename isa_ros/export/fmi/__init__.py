"""An actuator with its supply as a unit of the Functional Mock-up Interface, FMI 2.0 and 3.0."""
