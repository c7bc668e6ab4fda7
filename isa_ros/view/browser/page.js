'use strict';
// The page: what it gets first, its stream of frames, and the orders that every page has.

const $ = id => document.getElementById(id);
const SPANS = [1, 5, 20], SPEEDS = [0.01, 0.1, 0.25, 0.5, 1, 2, 5, 10], AS_FAST = 0;
let sent = 0;

function note(text, isBad) {
  $('note').textContent = text;
  $('note').hidden = !text;
  $('note').classList.toggle('bad', Boolean(isBad));
}

async function order(what, more) {
  const number = ++sent;
  try {
    const answer = await fetch('order', {
      method: 'POST', headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({ what, number, ...more }) });
    if (!answer.ok) note(`${what}: ${await answer.text()}`, true);
  } catch (error) {
    note(`${what}: ${error.message}`, true);
  }
  return number;
}

// Sends what a control has, one order at a time: of many values meanwhile the last.
function sending(post) {
  let isBusy = false, waits = null;
  return async function send(value) {
    if (isBusy) { waits = { value }; return; }
    isBusy = true;
    await post(value);
    isBusy = false;
    if (waits) { const next = waits.value; waits = null; send(next); }
  };
}

function choices(select, values, text, chosen) {
  for (const value of values) {
    const option = element(select, 'option', '', text(value));
    option.value = value;
    option.selected = value === chosen;
  }
}

class Traces {
  constructor(groups, store, onSource) {
    Object.assign(this, { groups, store, charts: [] });
    choices($('source'), groups.map((own, k) => k), k => groups[k].title, 0);
    choices($('window'), SPANS, span => `${span} s`, SPANS[1]);
    $('source').addEventListener('change', () => { this.show(); onSource(this.chosen); });
    onSource(this.chosen);
    $('window').addEventListener('change', () => this.update());
    this.show();
  }

  get chosen() { return this.groups[$('source').value]; }

  show() {
    for (const chart of this.charts) chart.remove();
    $('plots').replaceChildren();
    this.charts = (this.chosen ? this.chosen.panels : []).map(
      panel => new Chart($('plots'), panel, this.store, () => +$('window').value));
    this.update();
  }

  update() { for (const chart of this.charts) chart.update(); }
}

function header(meta) {
  document.title = `${meta.title} – isa view`;
  $('title').textContent = meta.title;
  choices($('speed'), meta.kind === 'run' ? [...SPEEDS, AS_FAST] : SPEEDS,
          speed => speed === AS_FAST ? 'as fast as possible' : `${speed} ×`, 1);
  $('speed').addEventListener('change', () => order('speed', { value: +$('speed').value }));
  $('pause').addEventListener('click', () => order('pause', { value: !latest.is_paused }));
  $('step').addEventListener('click', event => order('step', { value: event.shiftKey ? 100 : 1 }));
  $('restart').hidden = meta.kind === 'bag';
  $('restart').addEventListener('click', () => order('restart'));
  const seek = $('seek');
  if (meta.kind === 'bag') {
    Object.assign(seek, {
      hidden: false, min: meta.begin, max: meta.end, step: meta.step, value: meta.begin });
    const send = sending(value => order('seek', { value }));
    seek.addEventListener('input', () => send(+seek.value));
  }
  addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest('input, select, button, textarea')) return;
    if (event.key === ' ') { event.preventDefault(); $('pause').click(); }
    if (event.key === '.' || event.key === ':') order('step', { value: event.shiftKey ? 100 : 1 });
  });
}

function show(meta, frame) {
  $('clock').textContent = `${(frame.tick * meta.step).toFixed(3)} s`;
  $('pause').textContent = frame.is_paused ? 'go on' : 'pause';
  if (document.activeElement !== $('speed')) {
    if (![...$('speed').options].some(own => +own.value === frame.speed)) {
      choices($('speed'), [frame.speed], speed => `${speed} ×`);
    }
    $('speed').value = frame.speed;
  }
  if (document.activeElement !== $('seek')) $('seek').value = frame.tick * meta.step;
  $('state').textContent = frame.is_over ? 'ended' : frame.is_paused ? 'paused'
    : frame.behind > 0.2 ? `${frame.behind.toFixed(1)} s behind` : meta.kind === 'bag' ? 'plays' : 'runs';
}

let latest = { is_paused: false };

(async () => {
  const meta = await (await fetch('page.json')).json();
  const store = new Store(meta.channels, meta.step), stage = new Stage($('stage'), meta.scene);
  header(meta);
  const panel = meta.controls ? new Panel($('controls'), meta.controls, meta.title) : null;
  const traces = new Traces(meta.groups, store, group => panel && panel.show(group && group.name));
  if (meta.note) note(meta.note);
  let isDue = false, frames = 0;
  const draw = () => {
    isDue = false;
    show(meta, latest);
    traces.update();
    if (panel) panel.update(latest);
    if (store.n) stage.pose(channel => store.last[channel]);
    document.body.dataset.ready = document.body.dataset.frames = ++frames;
  };
  const stream = new EventSource('frames');
  stream.onmessage = event => {
    const frame = JSON.parse(event.data);
    store.add(frame);
    for (const answer of frame.answers) note(answer.text, !answer.is_done);
    latest = frame;
    if (frame.is_over) {
      stream.close();
      for (const own of document.querySelectorAll('button, #speed, #seek, aside input')) {
        own.disabled = true;
      }
    }
    if (!isDue) { isDue = true; requestAnimationFrame(draw); }
  };
  stream.onerror = () => {
    if (latest.is_over) return;
    $('state').textContent = 'no connection';
    note('No frames: the program has ended, or too many pages are open.', true);
  };
  stream.onopen = () => note(meta.note || '');
})();
