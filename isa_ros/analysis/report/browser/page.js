'use strict';
// Builds the page: groups of charts that share one part of time, lanes of states and events.

const meta = JSON.parse(document.getElementById('meta').textContent);
const view = new TimeView(meta.begin, meta.end, LEAST_SAMPLES * meta.step);

function lane(parent, group) {          // states as bands, events as ticks, above the charts
  const host = element(parent, 'div', 'lane'), placed = [];
  const put = (className, from, to, title) => {
    const made = element(host, 'span', className);
    made.title = title;
    placed.push({ made, from, to });
    return made;
  };
  for (const band of group.bands) {
    const title = `${band.source}: ${band.state} from t = ${band.from.toFixed(6)} s`;
    put(`band s-${band.state.replace(/ /g, '-')}`, band.from, band.to, title).textContent =
      group.isNamed ? `${band.source}: ${band.state}` : band.state;
  }
  for (const mark of group.marks) {
    const made = put(`mark k-${mark.kind}`, mark.t, mark.t, mark.text);
    made.addEventListener('click', () => around(mark.t));
  }
  const update = () => {
    const span = view.to - view.from;
    for (const { made, from, to } of placed) {
      const left = Math.max(0, (from - view.from) / span), right = Math.min(1, (to - view.from) / span);
      made.hidden = right < 0 || left > 1;
      made.style.left = `${100 * left}%`;
      made.style.width = from === to ? '' : `${100 * Math.max(0, right - left)}%`;
    }
  };
  view.listeners.push(update);
  update();
}

function around(t) { view.show(t - 0.05, t + 0.15); }

function addGroup(parent, group) {
  const details = element(parent, 'details', 'group');
  details.id = `group-${group.name}`;
  element(details, 'summary', '', group.title);
  const fill = () => {
    if (!details.open || details.dataset.filled) return;
    details.dataset.filled = '1';
    const sources = group.lanes ? [...new Set(group.bands.map(band => band.source))] : [];
    for (const source of sources) {
      lane(details, { isNamed: sources.length > 1,
                      bands: group.bands.filter(b => b.source === source),
                      marks: group.marks.filter(m => m.source === source) });
    }
    for (const panel of group.panels) new Chart(details, panel, group.marks, meta.grids, view);
  };
  details.addEventListener('toggle', fill);
  details.open = group.open;
  fill();
}

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const w = view.to - view.from, { from, to } = view;
  const action = {
    ArrowLeft: () => view.show(from - w / 4, to - w / 4),
    ArrowRight: () => view.show(from + w / 4, to + w / 4),
    '+': () => view.show(from + w / 4, to - w / 4),
    '-': () => view.show(from - w / 2, to + w / 2),
    0: () => view.all() }[event.key];
  if (action) { event.preventDefault(); action(); }
}

function showRange() {
  document.getElementById('range').textContent =
    `${view.from.toFixed(4)} to ${view.to.toFixed(4)} s`;
}

(async () => {
  const start = performance.now(), node = document.getElementById('data');
  await inflate(node.textContent);
  node.remove();
  const main = document.querySelector('main');
  for (const group of meta.groups) addGroup(main, group);
  document.getElementById('all').addEventListener('click', () => view.all());
  for (const row of document.querySelectorAll('[data-t]')) {
    row.addEventListener('click', () => { around(+row.dataset.t); main.scrollIntoView(); });
  }
  addEventListener('keydown', onKey);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => view.show(view.from, view.to));
  view.listeners.push(showRange);
  showRange();
  requestAnimationFrame(() => setTimeout(() => {
    document.body.dataset.ready = (performance.now() - start).toFixed(0);
  }));
})();
