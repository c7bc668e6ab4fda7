'use strict';
// One diagram of the page: a uPlot chart, its legend with exact samples, marks of events.

const HEIGHT = 170, LEFT = 64, RIGHT = 24, LEAST_SAMPLES = 20;

class TimeView {                        // the part of time that all charts show
  constructor(begin, end, least) {
    Object.assign(this, { begin, end, from: begin, to: end, least });
    this.listeners = [];
    this.pending = 0;
  }

  show(from, to) {
    if (to - from < this.least) {
      const middle = (from + to) / 2;
      from = middle - this.least / 2;
      to = middle + this.least / 2;
    }
    this.from = Math.max(this.begin, Math.min(from, this.end - this.least));
    this.to = Math.min(this.end, Math.max(to, this.begin + this.least));
    if (!this.pending) {
      this.pending = requestAnimationFrame(() => {
        this.pending = 0;
        for (const listener of this.listeners) listener();
      });
    }
  }

  all() { this.show(this.begin, this.end); }
}

class Chart {
  constructor(parent, panel, marks, grids, view) {
    Object.assign(this, { panel, marks, view, isVisible: false, isStale: false });
    const figure = element(parent, 'figure');
    this.host = element(figure, 'div', 'chart');
    this.host.setAttribute('role', 'img');
    this.host.setAttribute('aria-label', panel.label);
    this.curves = panel.curves.map(curve => {
      const grid = gridOf(grids, curve.grid);
      return { ...curve, own: grid, values: valuesOf(curve, grid.n) };
    });
    this.legend = this.makeLegend(figure);
    if (panel.caption) element(figure, 'figcaption', '', panel.caption);
    this.plot = new uPlot(this.options(), this.data(), this.host);
    this.listen();
    view.listeners.push(() => this.update());
  }

  color(curve) { return style(`--c${curve.color}`); }

  makeLegend(figure) {
    const legend = element(figure, 'div', 'legend');
    return this.curves.map(curve => {
      const entry = element(legend, 'span', `entry c${curve.color}${curve.dash ? ' dashed' : ''}`);
      element(entry, 'i');
      element(entry, 'span', '', curve.label);
      return element(entry, 'b', '', '–');
    });
  }

  options() {
    const axis = { stroke: () => style('--mut'), grid: { stroke: () => style('--line'), width: 1 },
                   ticks: { stroke: () => style('--line') }, font: '11px system-ui, sans-serif' };
    return {
      width: this.host.clientWidth || 800, height: HEIGHT, legend: { show: false },
      padding: [6, RIGHT, 0, 0],
      scales: { x: { time: false, auto: false, range: () => [this.view.from, this.view.to] } },
      axes: [
        { ...axis, size: 26, values: (u, ticks) => ticks.map(t => `${+t.toFixed(6)} s`) },
        { ...axis, size: LEFT, label: this.panel.label, labelSize: 18,
          labelFont: '12px system-ui, sans-serif',
          values: (u, ticks) => ticks.map(v => `${+v.toPrecision(6)}`) }],
      cursor: { sync: { key: 'time', scales: ['x', null] }, points: { show: false },
                drag: { x: true, y: false, setScale: false } },
      series: [{}, ...this.curves.map(curve => ({
        stroke: () => this.color(curve), width: 1.3, pxAlign: 0,
        dash: curve.dash ? [6, 4] : undefined, points: { show: this.isSparse(curve) } }))],
      hooks: { setSelect: [u => this.zoom(u)], setCursor: [u => this.read(u)],
               draw: [u => this.drawMarks(u)] } };
  }

  // Points are drawn where a few samples only are in view.
  isSparse(curve) {
    return () => curve.own.at(this.view.to) - curve.own.at(this.view.from) < 40;
  }

  data() {
    const pixels = Math.max(100, Math.floor(this.host.clientWidth || 800));
    const tables = this.curves.map(
      curve => thinned(curve.own, curve.values, this.view.from, this.view.to, pixels));
    return tables.length === 1 ? tables[0] : uPlot.join(tables);
  }

  zoom(u) {
    const { left, width } = u.select;
    if (width > 3) this.view.show(u.posToVal(left, 'x'), u.posToVal(left + width, 'x'));
    u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
  }

  read(u) {
    const left = u.cursor.left;
    const t = left === undefined || left < 0 ? null : u.posToVal(left, 'x');
    const slack = this.view.least / LEAST_SAMPLES;      // a run may end before another one
    this.curves.forEach((curve, k) => {
      const is = t !== null && t >= curve.own.t(0) - slack && t <= curve.own.t(curve.own.n - 1) + slack;
      this.legend[k].textContent = is ? shown(curve.values[curve.own.at(t)]) : '–';
    });
    const first = this.curves[0];
    document.getElementById('cursor').textContent =
      t === null ? '' : `t = ${first.own.t(first.own.at(t)).toFixed(6)} s`;
  }

  drawMarks(u) {
    const g = u.ctx, { top, height } = u.bbox, ratio = devicePixelRatio;
    g.save();
    g.lineWidth = ratio;
    g.setLineDash([4 * ratio, 3 * ratio]);
    for (const mark of this.marks) {
      if (mark.t < this.view.from || mark.t > this.view.to) continue;
      const x = u.valToPos(mark.t, 'x', true);
      g.strokeStyle = style(`--${mark.kind}`);
      g.beginPath();
      g.moveTo(x, top);
      g.lineTo(x, top + height);
      g.stroke();
    }
    g.restore();
  }

  listen() {
    const over = this.plot.over;
    over.addEventListener('dblclick', () => this.view.all());
    over.addEventListener('wheel', event => {
      if (!(event.ctrlKey || event.shiftKey || event.altKey)) return;
      event.preventDefault();
      const f = event.deltaY < 0 ? 0.75 : 1 / 0.75, t = this.plot.posToVal(event.offsetX, 'x');
      this.view.show(t - (t - this.view.from) * f, t + (this.view.to - t) * f);
    }, { passive: false });
    new IntersectionObserver(entries => {
      this.isVisible = entries[entries.length - 1].isIntersecting;
      if (this.isVisible && this.isStale) this.update();
    }, { rootMargin: '300px' }).observe(this.host);
    new ResizeObserver(() => {
      const width = this.host.clientWidth;
      if (width && width !== this.plot.width) {
        this.plot.setSize({ width, height: HEIGHT });
        this.update();
      }
    }).observe(this.host);
  }

  update() {
    this.isStale = !this.isVisible;
    if (this.isStale) return;
    this.plot.batch(() => {
      this.plot.setData(this.data(), false);
      this.plot.setScale('x', { min: this.view.from, max: this.view.to });
    });
  }
}
