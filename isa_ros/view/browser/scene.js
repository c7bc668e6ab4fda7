'use strict';
// Draws the nodes of the page in 3D on a plain canvas: boxes, cylinders and spheres as convex
// patches, those that face the eye from the farthest to the nearest. It needs no WebGL, which
// virtual machines and remote screens often lack; legs and robots have some thousand patches.

const SIDES = 20, RINGS = 8;            // of a cylinder and a sphere
const PARTS = 14;                       // patches along the size of the scene, for the order
const TURN = 0.008;                     // rad per pixel of the mouse
const FOCUS = 1.9, LIGHT = [-0.38, 0.6, 0.7];     // of the light: right, up, towards the eye

// Rotations are arrays of nine, row by row.
const apply = (r, v) => [r[0] * v[0] + r[1] * v[1] + r[2] * v[2],
                         r[3] * v[0] + r[4] * v[1] + r[5] * v[2],
                         r[6] * v[0] + r[7] * v[1] + r[8] * v[2]];
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const scaled = (a, k) => [a[0] * k, a[1] * k, a[2] * k];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const times = (a, b) => [0, 3, 6].flatMap(i => [0, 1, 2].map(
  k => a[i] * b[k] + a[i + 1] * b[k + 3] + a[i + 2] * b[k + 6]));

function turnAbout([x, y, z], angle) {
  const c = Math.cos(angle), s = Math.sin(angle), d = 1 - c;
  return [c + x * x * d, x * y * d - z * s, x * z * d + y * s,
          y * x * d + z * s, c + y * y * d, y * z * d - x * s,
          z * x * d - y * s, z * y * d + x * s, c + z * z * d];
}

function turnOf([w, x, y, z]) {         // of a quaternion
  const n = Math.hypot(w, x, y, z) || 1, [a, b, c, d] = [w / n, x / n, y / n, z / n];
  return [1 - 2 * (c * c + d * d), 2 * (b * c - a * d), 2 * (b * d + a * c),
          2 * (b * c + a * d), 1 - 2 * (b * b + d * d), 2 * (c * d - a * b),
          2 * (b * d - a * c), 2 * (c * d + a * b), 1 - 2 * (b * b + c * c)];
}

// Patches of a grid of points p(i, k), so that none is longer than `most`.
function patches(p, n, m) {
  const found = [];
  for (let i = 0; i < n; i++) {
    for (let k = 0; k < m; k++) found.push([p(i, k), p(i + 1, k), p(i + 1, k + 1), p(i, k + 1)]);
  }
  return found;
}

function patchesOf(shape, most) {
  const parts = length => Math.min(24, Math.max(1, Math.ceil(length / most)));
  if (shape.kind === 'sphere') {
    const r = shape.size[0];
    return patches((i, k) => {
      const a = Math.PI * i / RINGS, b = 2 * Math.PI * k / SIDES;
      return [r * Math.sin(a) * Math.cos(b), r * Math.sin(a) * Math.sin(b), r * Math.cos(a)];
    }, RINGS, SIDES);
  }
  if (shape.kind === 'cylinder') {
    const [r, length] = shape.size, n = parts(length);
    const at = (k, z) => [r * Math.cos(2 * Math.PI * k / SIDES), r * Math.sin(2 * Math.PI * k / SIDES), z];
    const lid = z => [...Array(SIDES).keys()].map(k => at(z > 0 ? k : -k, z));
    return [...patches((i, k) => at(k, length * (0.5 - i / n)), n, SIDES),
            lid(length / 2), lid(-length / 2)];
  }
  return [0, 1, 2].flatMap(axis => [-1, 1].flatMap(side => {
    const u = (axis + 1) % 3, v = (axis + 2) % 3, size = shape.size;
    const n = parts(size[u]), m = parts(size[v]);
    return patches((i, k) => {
      const point = [0, 0, 0];
      point[axis] = side * size[axis] / 2;
      point[u] = side * size[u] * (i / n - 0.5);
      point[v] = size[v] * (k / m - 0.5);
      return point;
    }, n, m);
  }));
}

function normalOf(points) {             // outwards: corners stand counterclockwise
  const [a, b, c] = [points[0], points[Math.floor(points.length / 3)],
                     points[Math.floor(2 * points.length / 3)]];
  const d = points[points.length - 1];
  const u = add(c, scaled(a, -1)), v = add(d, scaled(b, -1));
  const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.hypot(...n) || 1;
  return scaled(n, 1 / length);
}

class Stage {
  constructor(host, nodes) {
    Object.assign(this, { host, nodes, yaw: 0.9, pitch: 0.3, zoom: 1, pending: 0, radius: 0 });
    this.canvas = host.appendChild(document.createElement('canvas'));
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', '3D view: drag to turn, wheel to zoom');
    this.context = this.canvas.getContext('2d');
    this.frames = [];                   // place and rotation of each node in the world
    this.listen();
  }

  // Moves the nodes and draws them; `at(channel)` is the value of a channel, which may be missing (NaN).
  pose(at) {
    const value = channel => { const v = at(channel); return Number.isFinite(v) ? v : 0; };
    this.nodes.forEach((node, k) => {
      let place = node.place, turn = node.rotation;
      const q = node.channels.map(value);
      if (node.motion === 'turn') turn = times(turn, turnAbout(node.axis, q[0]));
      else if (node.motion === 'slide') place = add(place, apply(turn, scaled(node.axis, q[0])));
      else if (node.motion === 'free') {
        place = add(place, apply(turn, q.slice(0, 3)));
        turn = times(turn, turnOf(q.slice(3)));
      }
      const above = this.frames[node.parent];
      this.frames[k] = above ? { place: add(above.place, apply(above.turn, place)),
                                 turn: times(above.turn, turn) } : { place, turn };
    });
    if (!this.radius) this.fit();
    this.draw();
  }

  // Chooses eye and patches by the size of the scene in its first pose.
  fit() {
    const low = [Infinity, Infinity, 0], high = [-Infinity, -Infinity, 0];
    const each = (node, k) => node.shapes.forEach(shape => patchesOf(shape, Infinity).flat().forEach(p => {
      const { place, turn } = this.frames[k];
      const own = add(shape.place, apply(shape.rotation, p));
      for (const slid of [own, add(own, scaled(node.axis, node.reach))]) {
        add(place, apply(turn, slid)).forEach((x, i) => {
          low[i] = Math.min(low[i], x);
          high[i] = Math.max(high[i], x);
        });
      }
    }));
    this.nodes.forEach(each);
    const size = low[0] < Infinity ? Math.hypot(...high.map((x, i) => x - low[i])) / 2 : 1;
    this.radius = size || 1;
    this.centre = low[0] < Infinity ? scaled(add(low, high), 0.5) : [0, 0, 0];
    this.free = this.nodes.findIndex(node => node.motion === 'free');
    this.start = this.free < 0 ? null : this.frames[this.free].place;
    this.solids = this.nodes.map(node => node.shapes.flatMap(shape => patchesOf(
      shape, 2 * this.radius / PARTS).map(points => {
      const own = points.map(p => add(shape.place, apply(shape.rotation, p)));
      return { points: own, normal: normalOf(own), color: shape.color };
    })));
  }

  later() {
    if (!this.pending) this.pending = requestAnimationFrame(() => { this.pending = 0; this.draw(); });
  }

  eye() {
    const { yaw, pitch } = this, moved = this.start
      ? add(this.frames[this.free].place, scaled(this.start, -1)) : [0, 0, 0];
    const [c, s, d, e] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    return { target: add(this.centre, [moved[0], moved[1], 0]),
             turn: [-s, c, 0, -e * c, -e * s, d, d * c, d * s, e],    // right, up, towards the eye
             distance: 1.8 * this.radius * FOCUS / this.zoom };
  }

  draw() {
    const ratio = devicePixelRatio, g = this.context, canvas = this.canvas;
    const width = Math.round(this.host.clientWidth * ratio);
    const height = Math.round(this.host.clientHeight * ratio);
    if (!width || !height || !this.radius) return;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    g.clearRect(0, 0, width, height);
    const { target, turn, distance } = this.eye(), scale = FOCUS * Math.min(width, height) / 2;
    const seen = p => {
      const [x, y, z] = apply(turn, add(p, scaled(target, -1))), depth = distance - z;
      return [width / 2 + scale * x / depth, height / 2 - scale * y / depth, depth];
    };
    const eye = add(target, scaled([turn[6], turn[7], turn[8]], distance));
    this.drawFloor(g, seen, target, ratio);
    const style = getComputedStyle(document.documentElement);
    const colors = [0, 1, 2].map(k => style.getPropertyValue(`--solid${k}`).trim().split(' ').map(Number));
    const light = [0, 1, 2].map(i => turn[i] * LIGHT[0] + turn[3 + i] * LIGHT[1] + turn[6 + i] * LIGHT[2]);
    for (const { points, shade, color } of this.visible(eye, light, seen)) {
      g.beginPath();
      for (const [x, y] of points) g.lineTo(x, y);
      g.closePath();
      g.fillStyle = g.strokeStyle = `rgb(${colors[color].map(c => Math.round(c * shade)).join(' ')})`;
      g.fill();
      g.lineWidth = 0.7;                // closes the seams between patches
      g.stroke();
    }
  }

  // Patches that face the eye, the farthest first.
  visible(eye, light, seen) {
    const found = [];
    this.solids.forEach((patchList, k) => {
      const { place, turn } = this.frames[k];
      for (const { points, normal, color } of patchList) {
        const n = apply(turn, normal), world = points.map(p => add(place, apply(turn, p)));
        if (dot(n, add(eye, scaled(world[0], -1))) <= 0) continue;
        const flat = world.map(seen);
        if (flat.some(p => p[2] < 0.05 * this.radius)) continue;
        const depth = flat.reduce((sum, p) => sum + p[2], 0) / flat.length;
        found.push({ points: flat, depth, color, shade: 0.55 + 0.45 * Math.max(0, dot(n, light)) });
      }
    });
    return found.sort((a, b) => b.depth - a.depth);
  }

  drawFloor(g, seen, target, ratio) {
    const decade = 10 ** Math.floor(Math.log10(this.radius));
    const step = this.radius < 3 * decade ? decade / 5 : decade;
    const n = Math.min(30, Math.ceil(2 * this.radius / step));
    const [x0, y0] = [Math.round(target[0] / step) * step, Math.round(target[1] / step) * step];
    g.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue('--mut');
    g.globalAlpha = 0.3;
    g.lineWidth = ratio * 0.7;
    for (let k = -n; k <= n; k++) {
      for (const [a, b] of [[[x0 + k * step, y0 - n * step, 0], [x0 + k * step, y0 + n * step, 0]],
                            [[x0 - n * step, y0 + k * step, 0], [x0 + n * step, y0 + k * step, 0]]]) {
        const ends = [seen(a), seen(b)];
        if (ends.some(p => p[2] < 0.05 * this.radius)) continue;
        g.beginPath();
        g.moveTo(ends[0][0], ends[0][1]);
        g.lineTo(ends[1][0], ends[1][1]);
        g.stroke();
      }
    }
    g.globalAlpha = 1;
  }

  listen() {
    const canvas = this.canvas;
    let last = null;
    canvas.addEventListener('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId);
      last = event;
    });
    canvas.addEventListener('pointermove', event => {
      if (!event.buttons || !last) return;
      this.yaw -= (event.clientX - last.clientX) * TURN;
      this.pitch = Math.max(-0.2, Math.min(1.5, this.pitch + (event.clientY - last.clientY) * TURN));
      last = event;
      this.later();
    });
    canvas.addEventListener('wheel', event => {
      event.preventDefault();
      this.zoom = Math.max(0.2, Math.min(8, this.zoom * (event.deltaY < 0 ? 1.15 : 1 / 1.15)));
      this.later();
    }, { passive: false });
    canvas.addEventListener('dblclick', () => {
      Object.assign(this, { yaw: 0.9, pitch: 0.3, zoom: 1 });
      this.later();
    });
    new ResizeObserver(() => this.later()).observe(this.host);
  }
}
