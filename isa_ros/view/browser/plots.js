'use strict';
// Traces of the last seconds: a store of samples, and a uPlot chart for each panel of one source.

const HEIGHT = 116, LEFT = 64, MOST_ROWS = 60000, COLORS = 4;

class Store {                           // the samples of all channels, the oldest forgotten
  constructor(channels, step) {
    Object.assign(this, { step, n: 0, every: 1 });
    this.ticks = new Float64Array(MOST_ROWS);
    this.columns = Array.from({ length: channels }, () => new Float32Array(MOST_ROWS));
    this.last = new Float32Array(channels).fill(NaN);
  }

  // Rows of a frame. What is missing before them, or began anew, is a gap.
  add(frame) {
    if (!frame.n) return;
    const bytes = Uint8Array.from(atob(frame.y), c => c.charCodeAt(0));
    const rows = new DataView(bytes.buffer), width = this.columns.length;
    const before = this.n ? this.ticks[this.n - 1] : frame.first - 1;
    if (frame.first <= before) this.n = 0;
    else if (this.n && frame.first - before > Math.max(frame.every, this.every)) this.gap(before + 1);
    this.every = frame.every;
    this.room(frame.n);
    for (let i = 0; i < frame.n; i++) {
      this.ticks[this.n] = frame.first + i * frame.every;
      for (let k = 0; k < width; k++) {
        this.columns[k][this.n] = rows.getFloat32(4 * (i * width + k), true);
      }
      this.n++;
    }
    this.columns.forEach((column, k) => { this.last[k] = column[this.n - 1]; });
  }

  gap(tick) {
    this.room(1);
    this.ticks[this.n] = tick;
    for (const column of this.columns) column[this.n] = NaN;
    this.n++;
  }

  room(rows) {
    if (this.n + rows <= MOST_ROWS) return;
    const from = Math.floor(this.n / 2);
    for (const own of [this.ticks, ...this.columns]) own.copyWithin(0, from, this.n);
    this.n -= from;
  }

  get grid() {                          // as signals.js has it
    return { n: this.n, t: i => this.ticks[i] * this.step, at: t => {
      let low = 0, high = Math.max(0, this.n - 1);
      const tick = t / this.step;
      while (low < high) { const k = low + high >> 1; if (this.ticks[k] < tick) low = k + 1; else high = k; }
      return low;
    } };
  }
}

class Chart {
  constructor(parent, panel, store, span) {
    Object.assign(this, { panel, store, span });
    const figure = element(parent, 'figure');
    figure.style.margin = '0 0 4px';
    this.host = element(figure, 'div', 'chart');
    this.host.setAttribute('role', 'img');
    this.host.setAttribute('aria-label', panel.label);
    const legend = element(figure, 'div', 'legend');
    this.values = panel.curves.map((curve, k) => {
      element(legend, 'span', `c${k % COLORS}`, curve.label);
      return element(legend, 'b', '', '–');
    });
    this.plot = new uPlot(this.options(), [[0], ...panel.curves.map(() => [null])], this.host);
    this.observer = new ResizeObserver(() => {
      const width = this.host.clientWidth;
      if (width && width !== this.plot.width) this.plot.setSize({ width, height: HEIGHT });
    });
    this.observer.observe(this.host);
  }

  options() {
    const axis = { stroke: () => style('--mut'), grid: { stroke: () => style('--line'), width: 1 },
                   ticks: { stroke: () => style('--line') }, font: '11px system-ui, sans-serif' };
    return {
      width: this.host.clientWidth || 600, height: HEIGHT, legend: { show: false },
      padding: [6, 18, 0, 0], scales: { x: { time: false, auto: false, range: () => this.range() } },
      axes: [{ ...axis, size: 28, values: (u, ticks) => ticks.map(t => `${+t.toFixed(6)} s`) },
             { ...axis, size: LEFT, label: this.panel.label, labelSize: 18,
               labelFont: '12px system-ui, sans-serif' }],
      cursor: { sync: { key: 'time', scales: ['x', null] }, points: { show: false },
                drag: { x: false, y: false } },
      series: [{}, ...this.panel.curves.map((curve, k) => ({
        stroke: () => style(`--c${k % COLORS}`), width: 1.3, pxAlign: 0,
        dash: curve.dash ? [6, 4] : undefined, points: { show: false } }))] };
  }

  range() {
    const { n, grid } = this.store, span = this.span();
    const from = n ? Math.max(grid.t(0), grid.t(n - 1) - span) : 0;
    return [from, from + span];
  }

  update() {
    const { store, panel } = this, [from, to] = this.range(), grid = store.grid;
    const pixels = Math.max(100, this.plot.width - LEFT);
    const tables = panel.curves.map(curve => {
      const [x, y] = thinned(grid, store.columns[curve.channel], from, to, pixels);
      return [x, y.map(v => v === null ? null : v / panel.scale)];
    });
    this.plot.setData(tables.length === 1 ? tables[0] : uPlot.join(tables));
    const left = this.plot.cursor.left;
    const at = left === undefined || left < 0 ? store.n - 1 : grid.at(this.plot.posToVal(left, 'x'));
    panel.curves.forEach((curve, k) => {
      this.values[k].textContent = shown(store.columns[curve.channel][at] / panel.scale);
    });
  }

  remove() {
    this.observer.disconnect();
    this.plot.destroy();
  }
}
