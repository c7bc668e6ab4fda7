'use strict';
// What a page may change of a run: requests, setpoints, gains and faults of the chosen actuator.

const ANSWER_MS = 500;    // after which an order is in force, or refused

const worded = name => name.replace(/_/g, ' ');

class Panel {
  constructor(host, controls, title) {
    Object.assign(this, { host, controls, faults: [], setpoints: [] });
    host.hidden = false;
    this.stop = controls.has_stop ? element(host, 'button', 'stop', 'emergency stop') : null;
    this.own = element(host, 'section');
    if (this.stop) {
      this.stop.addEventListener('click', () => order('stop', { value: !this.isStopped }));
    }
    for (const supply of controls.supplies) this.addFaults(host, supply, `Faults of ${supply.name}`);
    this.shared = this.faults;
    element(element(host, 'p', 'mut'), 'small', '',
            `Everything that is changed here is in the bag of ${title} with its tick.`);
  }

  // Shows the controls of an actuator; of a body there are none.
  show(name) {
    this.own.replaceChildren();
    this.faults = [...this.shared];
    this.state = null;
    this.setpoints = [];
    this.row = this.controls.actuators.findIndex(actuator => actuator.name === name);
    const actuator = this.controls.actuators[this.row];
    if (!actuator) return;
    element(this.own, 'h2', '', `${actuator.name}, mode ${actuator.mode}`);
    this.state = element(this.own, 'p', 'state', '–');
    const requests = element(this.own, 'div', 'row');
    for (const request of this.controls.requests) {
      element(requests, 'button', '', worded(request)).addEventListener(
        'click', () => order('request', { of: name, name: request }));
    }
    element(this.own, 'h2', '', 'Setpoint');
    this.setpoints = actuator.setpoints.map(
      slider => this.addSlider(this.own, 'setpoint', name, slider));
    const gains = element(this.own, 'details');
    element(gains, 'summary', '', 'Gains and limits');
    for (const slider of actuator.gains) this.addSlider(gains, 'tune', name, slider);
    this.addFaults(this.own, actuator, 'Faults');
  }

  addSlider(parent, what, of, slider) {
    const label = element(parent, 'label', '', `${worded(slider.name)}, ${slider.unit}`);
    const output = element(label, 'output', '', shown(slider.value));
    const input = element(label, 'input');
    Object.assign(input, { type: 'range', min: 0, max: 1000, step: 1 });
    input.dataset.name = slider.name;
    const show = value => {
      slider.value = value;
      output.textContent = shown(value);
      input.value = 1000 * (value - slider.low) / (slider.high - slider.low);
    };
    show(slider.value);
    let moved = -Infinity;
    const send = sending(value => order(what, { of, name: slider.name, value: value * slider.scale }));
    input.addEventListener('input', () => {
      slider.value = slider.low + (slider.high - slider.low) * input.value / 1000;
      output.textContent = shown(slider.value);
      moved = performance.now();
      send(slider.value);
    });
    // Follows what is in force, but not under the hand that moves it, nor before its answer.
    return value => {
      const isHeld = input.matches(':active') || performance.now() - moved < ANSWER_MS;
      if (value !== null && !isHeld) show(value);
    };
  }

  addFaults(parent, target, title) {
    if (!target.faults.length) return;
    element(parent, 'h2', '', title);
    const row = element(parent, 'div', 'row');
    for (const fault of target.faults) {
      const button = element(row, 'button', 'fault', worded(fault.name));
      Object.assign(button, { title: fault.meaning });
      button.setAttribute('aria-pressed', false);
      button.addEventListener('click', () => order('fault', {
        of: target.name, name: fault.name, value: !button.classList.contains('on') }));
      this.faults.push({ button, of: target.name, name: fault.name });
    }
  }

  update(frame) {
    if (this.state) this.state.textContent = frame.devices[this.row];
    const inForce = this.setpoints.length ? frame.setpoints[this.row] : null;
    if (inForce) this.setpoints.forEach((follow, k) => follow(inForce[k]));
    for (const { button, of, name } of this.faults) {
      const isOn = frame.faults.some(own => own[0] === of && own[1] === name);
      button.classList.toggle('on', isOn);
      button.setAttribute('aria-pressed', isOn);
    }
    this.isStopped = frame.is_stopped;
    if (this.stop) {
      this.stop.textContent = frame.is_stopped ? 'release the emergency stop' : 'emergency stop';
      this.stop.classList.toggle('on', frame.is_stopped);
    }
  }
}
