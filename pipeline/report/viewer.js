// The view of report.html: draws the scene that pipeline/report/viewer_scene.cpp wrote, by WebGL 2 alone.
// Whatever goes wrong, the still picture stays and a line says why.
'use strict';
(() => {
  const root = document.getElementById('view');
  const data = document.getElementById('view-scene');
  if (!root || !data) return;
  const began = performance.now();
  const $ = (name) => root.querySelector('[data-part="' + name + '"]');
  const words = JSON.parse(document.getElementById('view-words').textContent);
  const say = (text) => words[text] || text;

  function still(why) {
    root.dataset.state = 'still';
    root.classList.remove('live');
    $('text').textContent = say('The picture stands in for the view') + ': ' + why;
  }

  // ---- reading -------------------------------------------------------------------------------------------
  async function unpacked(base64) {
    const text = atob(base64.trim());
    const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // The arrays follow each other by bytes, low ones first; scene_packer.hpp says how they are coded.
  function parsed(bytes) {
    const size = new DataView(bytes.buffer).getUint32(4, true);
    const scene = JSON.parse(new TextDecoder().decode(bytes.subarray(8, 8 + size)));
    const arrays = {};
    let at = 8 + size;
    for (const { name, count, bytes: width, follows } of scene.arrays) {
      const out = width === 1 ? new Uint8Array(count) : width === 2 ? new Uint16Array(count) : new Uint32Array(count);
      let last = 0, step = 0;
      for (let i = 0; i < count; ++i) {
        let n = 0;
        for (let plane = width - 1; plane >= 0; --plane) n = ((n << 8) | bytes[at + plane * count + i]) >>> 0;
        if (follows === 0) { out[i] = n; continue; }
        const change = (n >>> 1) ^ -(n & 1);
        step = follows === 2 ? step + change : change;
        last = (last + step) | 0;
        out[i] = last;  // the array's type takes what is over away
      }
      at += width * count;
      arrays[name] = out;
    }
    return { ...scene, ...arrays };
  }

  // ---- small vectors -------------------------------------------------------------------------------------
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = (a) => { const n = Math.hypot(...a) || 1; return a.map((x) => x / n); };

  const SURFACE = `#version 300 es
    in vec3 place; in vec2 folded; in float value; in float strip;
    uniform mat4 camera; uniform vec3 low, size; uniform float back;
    out vec3 at, normal; out float shade_value; flat out int of_strip;
    void main() {
      at = low + place * size;
      vec2 f = folded * 2.0 - 1.0;
      normal = vec3(f, 1.0 - abs(f.x) - abs(f.y));
      if (normal.z < 0.0) normal.xy = (1.0 - abs(normal.yx)) * vec2(normal.x < 0.0 ? -1.0 : 1.0, normal.y < 0.0 ? -1.0 : 1.0);
      shade_value = value; of_strip = int(strip + 0.5);
      gl_Position = camera * vec4(at, 1.0); gl_Position.z += back;
    }`;
  const SHADE = `#version 300 es
    precision highp float; precision highp int;
    in vec3 at, normal; in float shade_value; flat in int of_strip;
    uniform sampler2D key; uniform vec3 eye, plain; uniform vec4 clip; uniform int mode, chosen; uniform vec3 palette[8];
    out vec4 color;
    void main() {
      if (dot(clip.xyz, at) > clip.w) discard;
      vec3 c = mode == 0 ? plain : mode == 1 ? palette[of_strip % 8] : texelFetch(key, ivec2(int(shade_value * 255.0 + 0.5), 0), 0).rgb;
      if (mode > 0 && chosen >= 0 && of_strip != chosen) c = mix(c, vec3(0.93), 0.72);
      color = vec4(c * (0.66 + 0.38 * abs(dot(normalize(normal), eye))), 1.0);
    }`;
  const LINE = `#version 300 es
    in vec3 place; uniform mat4 camera; uniform vec3 low, size; uniform float back, dot_size; out vec3 at;
    void main() { at = low + place * size; gl_Position = camera * vec4(at, 1.0); gl_Position.z += back; gl_PointSize = dot_size; }`;
  const INK = `#version 300 es
    precision highp float; in vec3 at; uniform vec3 plain; uniform vec4 clip; out vec4 color;
    void main() { if (dot(clip.xyz, at) > clip.w) discard; color = vec4(plain, 1.0); }`;

  const COLORS = ['deviation', 'strip', 'curvature', 'margin', 'feed'];
  const LAYERS = { d: 'design', c: 'cut', r: 'ribs', b: 'blocks', g: 'ghosts', n: 'names' };
  const VIEWS = { t: [[0, 0, 1], [0, 1, 0]], f: [[0, -1, 0], [0, 0, 1]], s: [[1, 0, 0], [0, 0, 1]] };

  // Is there no graphics card? Smooth edges then cost twice the time, and frames while it moves are thinned.
  function drawn_by_processor() {
    const gl = document.createElement('canvas').getContext('webgl2');
    const info = gl && gl.getExtension('WEBGL_debug_renderer_info');
    const name = gl ? gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER) : '';
    if (gl) gl.getExtension('WEBGL_lose_context')?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  }

  function start(scene) {
    const canvas = $('canvas'), stage = $('stage');
    const soft = drawn_by_processor();
    const gl = canvas.getContext('webgl2', { antialias: !soft });
    if (!gl) return still(say('this browser has no WebGL 2'));
    canvas.addEventListener('webglcontextlost', (e) => { e.preventDefault(); still(say('the graphics context was lost')); });

    const [low, size] = scene.box;
    const middle = low.map((x, i) => x + size[i] / 2), diagonal = Math.hypot(...size) || 1;
    const rows = scene.row_done.length, cut_triangles = scene.cut_corners.length / 3;
    const design_triangles = scene.design_corners.length / 3;
    const names = COLORS.filter((name) => name !== 'strip' ? scene[name] : rows);
    const coloring = (name) => scene.colors.find((c) => c.name === name);
    const shown = { design: true, cut: true, ribs: true, blocks: true, ghosts: true, names: true };
    const state = { color: names[0] || 'none', row: rows, chosen: -1, clip: -1, clip_at: 0.5, flipped: false };
    const camera = { eye: [0, 0, 1], up: [0, 1, 0], target: middle, mm_per_pixel: 1 };

    // ---- what the graphics card holds --------------------------------------------------------------------
    function program(vertex, fragment) {
      const p = gl.createProgram();
      for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const s = gl.createShader(type);
        gl.shaderSource(s, text); gl.compileShader(s);
        if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s));
        gl.attachShader(p, s);
      }
      ['place', 'folded', 'value', 'strip'].forEach((name, i) => gl.bindAttribLocation(p, i, name));
      gl.linkProgram(p);
      if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
      const at = {};
      for (let i = 0; i < gl.getProgramParameter(p, gl.ACTIVE_UNIFORMS); ++i) {
        const name = gl.getActiveUniform(p, i).name;
        at[name.replace('[0]', '')] = gl.getUniformLocation(p, name);
      }
      return { p, at };
    }
    const surface = program(SURFACE, SHADE), ink = program(LINE, INK);

    function places(name) {
      const [x, y, z] = ['x', 'y', 'z'].map((axis) => scene[name + '_' + axis]);
      const out = new Uint16Array(3 * x.length);
      for (let i = 0; i < x.length; ++i) { out[3 * i] = x[i]; out[3 * i + 1] = y[i]; out[3 * i + 2] = z[i]; }
      return out;
    }
    function buffer(values, target = gl.ARRAY_BUFFER) {
      const b = gl.createBuffer();
      gl.bindBuffer(target, b); gl.bufferData(target, values, gl.STATIC_DRAW);
      return b;
    }
    function attribute(index, values, count, type, normalized) {
      buffer(values);
      gl.enableVertexAttribArray(index);
      gl.vertexAttribPointer(index, count, type, normalized, 0, 0);
    }
    function object(place_values, normal, corners) {
      const vao = gl.createVertexArray();
      gl.bindVertexArray(vao);
      attribute(0, place_values, 3, gl.UNSIGNED_SHORT, true);
      if (normal) {
        const u = scene[normal + '_u'], v = scene[normal + '_v'], uv = new Uint8Array(2 * u.length);
        for (let i = 0; i < u.length; ++i) { uv[2 * i] = u[i]; uv[2 * i + 1] = v[i]; }
        attribute(1, uv, 2, gl.UNSIGNED_BYTE, true);
      }
      if (corners) buffer(corners, gl.ELEMENT_ARRAY_BUFFER);
      return vao;
    }
    const cut_places = places('cut');
    const row_size = (r) => (r + 1 < rows ? scene.row_first[r + 1] : cut_places.length / 3) - scene.row_first[r];
    const strips = new Uint16Array(cut_places.length / 3);
    for (let r = 0; r < rows; ++r) strips.fill(scene.row_strip[r], scene.row_first[r], scene.row_first[r] + row_size(r));
    const design = object(places('design'), 'design_normal', scene.design_corners);
    const cut = object(cut_places, 'cut_normal', scene.cut_corners);
    attribute(3, strips, 1, gl.UNSIGNED_SHORT, false);
    const values = {}, keys = {};
    for (const name of names.filter((n) => n !== 'strip')) {
      values[name] = buffer(scene[name]);
      keys[name] = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, keys[name]);
      gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, scene[name + '_colors']);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    }
    // The cut by every few rows and points of them, for frames while it moves.
    function thinned(step) {
      const used = new Uint8Array(strips.length), corners = [];
      for (const i of scene.cut_corners) used[i] = 1;
      const add = (a, b, c) => { if (used[a] && used[b] && used[c]) corners.push(a, b, c); };
      for (let r = 0; r + 1 < rows;) {
        let next = Math.min(r + step, rows - 1);
        while (scene.row_strip[next] !== scene.row_strip[r]) --next;
        if (next === r) { ++r; continue; }
        const n = row_size(r), from = scene.row_first[r], to = scene.row_first[next];
        for (let c = 0; c + 1 < n;) {
          const d = Math.min(c + step, n - 1);
          add(from + c, from + d, to + d); add(from + c, to + d, to + c);
          c = d;
        }
        r = next;
      }
      return new Uint32Array(corners);
    }
    const MOVING = 12000;  // triangles: software draws some thirty such frames a second
    const coarse_corners = soft && cut_triangles > MOVING ? thinned(Math.ceil(Math.sqrt(cut_triangles / MOVING))) : null;
    const coarse = coarse_corners && object(cut_places, 'cut_normal', coarse_corners);
    if (coarse) attribute(3, strips, 1, gl.UNSIGNED_SHORT, false);
    gl.bindVertexArray(null);
    const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
    const palette = new Float32Array(24);
    for (let i = 0; i < 8; ++i) palette.set(scene.strips.length ? rgb(scene.strips[i % scene.strips.length].color) : [1, 1, 1], 3 * i);

    // Lines as pairs of points, one kind after the other.
    const line_places = places('line'), pairs = [], kinds = {};
    { let line = 0, point = 0;
      for (const [kind, count] of Object.entries(scene.lines)) {
        const from = pairs.length;
        for (let i = 0; i < count; ++i, ++line) {
          for (let k = 1; k < scene.line_points[line]; ++k) pairs.push(point + k - 1, point + k);
          point += scene.line_points[line];
        }
        kinds[kind] = [from, pairs.length - from];
      } }
    const lines = object(line_places, null, new Uint32Array(pairs));
    const dots = { a: object(places('clamp_a')), b: object(places('clamp_b')) };
    const dot_count = { a: scene.clamp_a_x.length, b: scene.clamp_b_x.length };

    // ---- the camera --------------------------------------------------------------------------------------
    const right = () => unit(cross(camera.up, camera.eye));
    const true_up = () => cross(camera.eye, right());
    const depth = 2 * diagonal;
    function matrix() {
      const w = canvas.clientWidth / 2 * camera.mm_per_pixel, h = canvas.clientHeight / 2 * camera.mm_per_pixel;
      const r = right(), u = true_up(), e = camera.eye, t = camera.target;
      return new Float32Array([r[0] / w, u[0] / h, -e[0] / depth, 0, r[1] / w, u[1] / h, -e[1] / depth, 0,
        r[2] / w, u[2] / h, -e[2] / depth, 0, -dot(r, t) / w, -dot(u, t) / h, dot(e, t) / depth, 1]);
    }
    // Pixels from the middle to the right and up, and the distance towards the eye in mm.
    function seen(p) {
      const d = p.map((x, i) => x - camera.target[i]);
      return [dot(d, right()) / camera.mm_per_pixel, dot(d, true_up()) / camera.mm_per_pixel, dot(d, camera.eye)];
    }
    function fit() {
      const r = right(), u = true_up();
      let w = 0, h = 0;
      for (let i = 0; i < 8; ++i) {
        const d = size.map((s, axis) => ((i >> axis & 1) - 0.5) * s);
        w = Math.max(w, Math.abs(dot(d, r))); h = Math.max(h, Math.abs(dot(d, u)));
      }
      camera.target = middle;
      camera.mm_per_pixel = 1.08 * Math.max(2 * w / Math.max(canvas.clientWidth, 1), 2 * h / Math.max(canvas.clientHeight, 1)) || 1;
    }
    function view(key) {
      if (VIEWS[key]) { [camera.eye, camera.up] = VIEWS[key]; }
      else { camera.eye = best_eye(); camera.up = [0, 0, 1]; }
      fit(); draw();
    }
    // From above and the front, unless the cut side looks elsewhere, as preview/camera.cpp chooses it.
    function best_eye() {
      const from = (az, el) => [Math.sin(az) * Math.cos(el), -Math.cos(az) * Math.cos(el), Math.sin(el)];
      const usual = from(-32 * Math.PI / 180, 36 * Math.PI / 180), waste = scene.eye;
      if (!waste.some((x) => x)) return usual;
      let best = usual, most = -10;
      for (let az = -152; az <= 148; az += 60) for (const el of [36, 20, -20, -36]) {
        const eye = from(az * Math.PI / 180, el * Math.PI / 180);
        const score = -Math.abs(dot(eye, waste) - 0.65) + 0.25 * dot(eye, usual);
        if (score > most) { most = score; best = eye; }
      }
      return best;
    }
    function turn(dx, dy) {
      let azimuth = Math.atan2(camera.eye[0], -camera.eye[1]), elevation = Math.asin(Math.max(-1, Math.min(1, camera.eye[2])));
      if (Math.abs(camera.eye[2]) > 0.9999) azimuth = Math.atan2(-camera.up[0], camera.up[1]) * Math.sign(camera.eye[2]);
      azimuth -= dx; elevation = Math.max(-1.57, Math.min(1.57, elevation + dy));
      camera.eye = [Math.sin(azimuth) * Math.cos(elevation), -Math.cos(azimuth) * Math.cos(elevation), Math.sin(elevation)];
      camera.up = Math.abs(camera.eye[2]) > 0.9999 ? [-Math.sin(azimuth), Math.cos(azimuth), 0] : [0, 0, 1];
      draw_moving();
    }
    function pan(dx, dy) {
      const r = right(), u = true_up(), s = camera.mm_per_pixel;
      camera.target = camera.target.map((x, i) => x - dx * s * r[i] + dy * s * u[i]);
      draw_moving();
    }
    function zoom(by, x = 0, y = 0) {
      const r = right(), u = true_up(), s = camera.mm_per_pixel;
      by = Math.max(diagonal / 2e5, Math.min(diagonal / 20, s * by)) / s;
      camera.target = camera.target.map((p, i) => p + (1 - by) * s * (x * r[i] + y * u[i]));
      camera.mm_per_pixel = s * by;
      draw_moving();
    }

    // ---- drawing, only on change -------------------------------------------------------------------------
    const clip_vector = () => {
      if (state.clip < 0) return [0, 0, 0, 1];
      const sign = state.flipped ? -1 : 1, v = [0, 0, 0];
      v[state.clip] = sign;
      return [...v, sign * (low[state.clip] + state.clip_at * size[state.clip])];
    };
    let waiting = false, frames = 0, moving = 0;
    function draw_moving() {
      clearTimeout(moving);
      moving = coarse ? setTimeout(() => { moving = 0; draw(); }, 200) : 0;
      draw();
    }
    function draw() {
      if (!waiting && root.classList.contains('live')) { waiting = true; requestAnimationFrame(paint); }
    }
    const mm_back = (mm) => mm / depth;
    function use(which) {
      gl.useProgram(which.p);
      gl.uniformMatrix4fv(which.at.camera, false, matrix());
      gl.uniform3fv(which.at.low, low); gl.uniform3fv(which.at.size, size);
      gl.uniform4fv(which.at.clip, clip_vector());
    }
    function paint() {
      waiting = false;
      const ratio = Math.min(window.devicePixelRatio || 1, 2);
      const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
      if (!width || !height) return;
      if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
      gl.viewport(0, 0, width, height);
      gl.clearColor(0.925, 0.935, 0.945, 1);
      gl.enable(gl.DEPTH_TEST); gl.depthFunc(gl.LEQUAL);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      use(surface);
      gl.uniform3fv(surface.at.eye, camera.eye);
      const thin = moving && coarse && state.row >= rows;
      if (shown.design && design_triangles && !(thin && shown.cut && design_triangles > MOVING / 2)) {
        gl.bindVertexArray(design);
        gl.uniform1i(surface.at.mode, 0); gl.uniform3f(surface.at.plain, 0.78, 0.79, 0.80);
        gl.uniform1f(surface.at.back, mm_back(rows ? scene.apart_mm : 0));
        gl.drawElements(gl.TRIANGLES, 3 * design_triangles, gl.UNSIGNED_INT, 0);
      }
      const done = state.row >= rows ? cut_triangles : scene.row_done[state.row];
      if (shown.cut && rows) {
        gl.bindVertexArray(thin ? coarse : cut);
        const by_strip = state.color === 'strip';
        gl.uniform1i(surface.at.mode, by_strip ? 1 : 2); gl.uniform1i(surface.at.chosen, state.chosen);
        gl.uniform3fv(surface.at.palette, palette); gl.uniform1f(surface.at.back, 0);
        if (by_strip) gl.disableVertexAttribArray(2);
        else {
          gl.bindTexture(gl.TEXTURE_2D, keys[state.color]);
          gl.bindBuffer(gl.ARRAY_BUFFER, values[state.color]);
          gl.enableVertexAttribArray(2); gl.vertexAttribPointer(2, 1, gl.UNSIGNED_BYTE, true, 0, 0);
        }
        gl.drawElements(gl.TRIANGLES, thin ? coarse_corners.length : 3 * done, gl.UNSIGNED_INT, 0);
      }
      use(ink);
      const before = -mm_back(Math.max(scene.apart_mm, diagonal / 400));
      gl.bindVertexArray(lines);
      const stroke = (kind, color, back, from_line = 0, count = kinds[kind][1]) => {
        gl.uniform3fv(ink.at.plain, color); gl.uniform1f(ink.at.back, back);
        if (count) gl.drawElements(gl.LINES, count, gl.UNSIGNED_INT, 4 * (kinds[kind][0] + from_line));
      };
      if (shown.design) stroke('borders', [0.13, 0.15, 0.18], before);
      if (shown.ribs) stroke('ribs', [0.42, 0.45, 0.50], before);
      if (shown.ghosts) stroke('blades', [0.20, 0.42, 0.62], before);
      if (shown.blocks) {
        stroke('blocks', [0.55, 0.57, 0.60], 0);
        if (state.chosen >= 0) stroke('blocks', [0.95, 0.10, 0.55], before, 24 * state.chosen, 24);
      }
      if (shown.ghosts) for (const [end, color] of [['a', [0.10, 0.55, 0.30]], ['b', [0.85, 0.50, 0.05]]]) {
        gl.bindVertexArray(dots[end]); gl.uniform3fv(ink.at.plain, color);
        gl.uniform1f(ink.at.back, before); gl.uniform1f(ink.at.dot_size, 6 * ratio);
        gl.drawArrays(gl.POINTS, 0, dot_count[end]);
      }
      if (state.row < rows) {  // the blade, in the foam
        gl.bindVertexArray(cut);
        gl.uniform3f(ink.at.plain, 0.85, 0.10, 0.10); gl.uniform1f(ink.at.back, 2 * before);
        gl.drawArrays(gl.LINE_STRIP, scene.row_first[state.row], row_size(state.row));
      }
      gl.bindVertexArray(null);
      labels();
      root.dataset.frames = ++frames;
    }

    // Names of the blocks, those in front first; one that would cover another is left out.
    const cover = $('labels'), tags = [];
    scene.strips.forEach((s, i) => {
      const tag = document.createElement('button');
      tag.type = 'button'; tag.textContent = s.id; tag.tabIndex = -1;
      tag.onclick = () => choose(i, true);
      tags.push(cover.appendChild(tag));
    });
    const rings = scene.marks.map((mark) => {
      const ring = document.createElement('div');
      ring.className = 'ring'; ring.title = say(mark.words);
      ring.innerHTML = '<span></span>'; ring.firstChild.textContent = say(mark.words);
      return cover.appendChild(ring);
    });
    function put(element, p) {
      const [x, y] = seen(p);
      element.style.transform = 'translate(' + (canvas.clientWidth / 2 + x).toFixed(1) + 'px,' + (canvas.clientHeight / 2 - y).toFixed(1) + 'px) translate(-50%,-50%)';
    }
    function labels() {
      const taken = [];
      const order = scene.strips.map((s, i) => [i === state.chosen ? Infinity : seen(s.middle)[2], i]).sort((a, b) => b[0] - a[0]);
      for (const [, i] of order) {
        const [x, y] = seen(scene.strips[i].middle);
        const inside = Math.abs(x) < canvas.clientWidth / 2 - 14 && Math.abs(y) < canvas.clientHeight / 2 - 8;
        const free = shown.names && inside && !taken.some(([u, v]) => Math.abs(u - x) < 42 && Math.abs(v - y) < 20);
        tags[i].hidden = !free;
        if (free) { taken.push([x, y]); put(tags[i], scene.strips[i].middle); tags[i].className = i === state.chosen ? 'chosen' : ''; }
      }
      rings.forEach((ring, i) => {
        put(ring, scene.marks[i].at);
        // Its words stand on its left where they would not fit on its right.
        const end = canvas.clientWidth / 2 + seen(scene.marks[i].at)[0] + 24 + ring.firstChild.offsetWidth;
        ring.classList.toggle('left', end > canvas.clientWidth);
      });
    }

    // ---- picking: the nearest triangle under the pointer -------------------------------------------------
    function strip_at(x, y) {
      const r = right().map((v, i) => v * size[i] / 65535 / camera.mm_per_pixel), u = true_up().map((v, i) => v * size[i] / 65535 / camera.mm_per_pixel);
      const e = camera.eye.map((v, i) => v * size[i] / 65535), base = seen(low);
      const n = cut_places.length / 3, sx = new Float32Array(n), sy = new Float32Array(n), sz = new Float32Array(n);
      for (let i = 0, k = 0; i < n; ++i, k += 3) {
        const a = cut_places[k], b = cut_places[k + 1], c = cut_places[k + 2];
        sx[i] = base[0] + a * r[0] + b * r[1] + c * r[2] - x;
        sy[i] = base[1] + a * u[0] + b * u[1] + c * u[2] - y;
        sz[i] = base[2] + a * e[0] + b * e[1] + c * e[2];
      }
      const done = 3 * (state.row >= rows ? cut_triangles : scene.row_done[state.row]), q = scene.cut_corners;
      const clip = clip_vector();
      let nearest = -Infinity, found = -1;
      for (let t = 0; t < done; t += 3) {
        const a = q[t], b = q[t + 1], c = q[t + 2];
        const ab = sx[a] * sy[b] - sx[b] * sy[a], bc = sx[b] * sy[c] - sx[c] * sy[b], ca = sx[c] * sy[a] - sx[a] * sy[c];
        if (!(ab >= 0 && bc >= 0 && ca >= 0) && !(ab <= 0 && bc <= 0 && ca <= 0)) continue;
        const area = ab + bc + ca;
        if (!area) continue;
        const z = (bc * sz[a] + ca * sz[b] + ab * sz[c]) / area;
        if (z <= nearest) continue;
        const p = [0, 1, 2].map((i) => low[i] + cut_places[3 * a + i] / 65535 * size[i]);
        if (dot(clip, p) > clip[3]) continue;
        nearest = z; found = strips[a];
      }
      return found;
    }

    // ---- one strip: its card, its row, its block ---------------------------------------------------------
    const row_of = (id) => document.querySelectorAll('tr[data-strip="' + id + '"]');
    function choose(i, scroll_to_card) {
      if (state.chosen >= 0) row_of(scene.strips[state.chosen].id).forEach((tr) => tr.classList.remove('chosen'));
      state.chosen = i === state.chosen && scroll_to_card ? -1 : i;
      const card = $('card');
      card.hidden = state.chosen < 0;
      if (state.chosen >= 0) {
        const id = scene.strips[i].id;
        card.replaceChildren();
        const head = card.appendChild(document.createElement('b'));
        head.textContent = id;
        const list = card.appendChild(document.createElement('dl'));
        row_of(id).forEach((tr) => {
          tr.classList.add('chosen');
          const heads = tr.closest('table').rows[0].cells;
          for (let c = 1; c < tr.cells.length; ++c) {
            const [name, unit_text] = [heads[c].firstChild.textContent, heads[c].querySelector('small').textContent];
            list.appendChild(document.createElement('dt')).textContent = name;
            list.appendChild(document.createElement('dd')).textContent = tr.cells[c].textContent + (unit_text ? ' ' + unit_text : '');
          }
        });
        for (const [name, to] of [['its row', 'strip-' + id], ['its sheet', 'sheet-' + id], ['why', 'why-' + id]]) {
          if (!document.getElementById(to)) continue;
          const link = card.appendChild(document.createElement('a'));
          link.href = '#' + to; link.textContent = say(name);
        }
      }
      root.dataset.strip = state.chosen < 0 ? '' : scene.strips[state.chosen].id;
      tell(); draw();
    }
    scene.strips.forEach((s, i) => row_of(s.id).forEach((tr) => {
      const button = document.createElement('button');
      button.type = 'button'; button.className = 'pick'; button.textContent = tr.cells[0].textContent;
      button.setAttribute('aria-label', say('show in the view') + ': ' + s.id);
      tr.cells[0].replaceChildren(button);
      button.onclick = () => { choose(i, false); root.scrollIntoView({ block: 'nearest' }); };
    }));

    // ---- words -------------------------------------------------------------------------------------------
    function tell() {
      const parts = [];
      if (rows && shown.cut) parts.push(say('cut coloured by') + ' ' + say(state.color));
      for (const [, name] of Object.entries(LAYERS)) if (shown[name] && name !== 'cut') parts.push(say(name));
      let text = say('Shown') + ': ' + parts.join(', ') + '. ' + (cut_triangles + design_triangles) + ' ' + say('triangles') + ', ' + scene.strips.length + ' ' + say(scene.strips.length === 1 ? 'strip' : 'strips') + '.';
      if (scene.steps[0] > 1 || scene.steps[1] > 1) text += ' ' + say('One row of the cut in') + ' ' + scene.steps[0] + ', ' + say('one point of a row in') + ' ' + scene.steps[1] + '.';
      if (design_triangles < scene.design_triangles) text += ' ' + say('The design is drawn coarser than it is') + ': ' + design_triangles + ' / ' + scene.design_triangles + ' ' + say('triangles') + '.';
      if (state.row < rows) text += ' ' + say('Cut so far') + ': ' + moment() + '.';
      if (state.clip >= 0) text += ' ' + say('Clipped at') + ' ' + 'xyz'[state.clip] + ' = ' + (low[state.clip] + state.clip_at * size[state.clip]).toFixed(0) + ' mm.';
      if (state.chosen >= 0) text += ' ' + say('Chosen') + ': ' + scene.strips[state.chosen].id + '.';
      for (const mark of scene.marks) text += ' ' + say('Ringed') + ': ' + say(mark.words) + ' (' + mark.at.map((x) => x.toFixed(1)).join(', ') + ').';
      $('text').textContent = text;
      root.dataset.color = state.color; root.dataset.row = state.row;
    }
    const moment = () => scene.strips[scene.row_strip[state.row]].id + ', ' + (scene.row_tenths[state.row] / 10).toFixed(1) + ' s';
    function legend() {
      const box = $('key'), c = coloring(state.color);
      box.replaceChildren();
      const title = box.appendChild(document.createElement('b'));
      title.textContent = state.color === 'none' ? '' : c && c.title ? say(c.title) : say('strip');
      if (!c || !c.ticks) return;
      const bar = box.appendChild(document.createElement('div')), stops = [], colors = scene[state.color + '_colors'];
      bar.className = 'bar';
      for (let i = 0; i < 256; i += 3) stops.push('rgb(' + [0, 1, 2].map((k) => colors[3 * i + k]).join() + ')');
      bar.style.background = 'linear-gradient(to right,' + stops.join() + ')';
      for (const tick of c.ticks) {
        const mark = bar.appendChild(document.createElement('span'));
        mark.textContent = tick.words; mark.style.left = (100 * tick.at).toFixed(1) + '%';
      }
      const note = box.appendChild(document.createElement('small'));
      note.textContent = c.tolerance ? say('cut too deep') + ' − … + ' + say('foam left standing') + ', ' + say('tolerance') + ' ±' + c.tolerance
        : c.limit ? say('allowed') + ' ' + c.limit.toFixed(0) : '';
    }

    // ---- controls ----------------------------------------------------------------------------------------
    const color = $('colour'), sweep = $('sweep'), clip = $('clip'), clip_at = $('clip-at');
    for (const name of names) color.add(new Option((COLORS.indexOf(name) + 1) + ' ' + say(name), name));
    sweep.max = rows; sweep.value = rows;
    color.disabled = sweep.disabled = !rows;
    function set_color(name) { if (names.includes(name)) { state.color = color.value = name; legend(); tell(); draw(); } }
    function set_row(row) {
      state.row = Math.max(0, Math.min(rows, row)); sweep.value = state.row;
      sweep.setAttribute('aria-valuetext', state.row < rows ? moment() : say('the whole cut'));
      $('sweep-text').textContent = state.row < rows ? moment() : say('the whole cut');
      tell(); draw();
    }
    function set_clip(axis) {
      state.clip = axis; clip.value = axis; clip_at.disabled = axis < 0;
      tell(); draw();
    }
    function set_layer(name, on) {
      shown[name] = on; $('layer-' + name).checked = on;
      tell(); draw();
    }
    color.onchange = () => set_color(color.value);
    sweep.oninput = () => set_row(+sweep.value);
    clip.onchange = () => set_clip(+clip.value);
    clip_at.oninput = () => { state.clip_at = +clip_at.value / 1000; tell(); draw(); };
    const flip = () => { state.flipped = !state.flipped; tell(); draw(); };
    $('flip').onclick = flip;
    for (const name of Object.values(LAYERS)) $('layer-' + name).onchange = (e) => set_layer(name, e.target.checked);
    root.querySelectorAll('[data-view]').forEach((b) => { b.onclick = () => view(b.dataset.view); });

    const step_strip = (by) => { const n = scene.strips.length; if (n) choose(state.chosen < 0 ? (by > 0 ? 0 : n - 1) : (state.chosen + by + n) % n, false); };
    stage.addEventListener('keydown', (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey || e.target !== stage) return;
      const far = e.shiftKey, arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      if (arrows[e.key]) { const [x, y] = arrows[e.key]; if (far) pan(24 * x, 24 * y); else turn(0.12 * x, 0.12 * y); }
      else if ('tfsi'.includes(e.key)) view(e.key);
      else if (e.key === '0') { set_clip(-1); view('i'); }
      else if ('12345'.includes(e.key)) set_color(COLORS[e.key - 1]);
      else if (LAYERS[e.key]) set_layer(LAYERS[e.key], !shown[LAYERS[e.key]]);
      else if (e.key === '+' || e.key === '-') zoom(e.key === '+' ? 1 / 1.2 : 1.2);
      else if (e.key === 'x') set_clip(state.clip > 1 ? -1 : state.clip + 1);
      else if (e.key === 'X') flip();
      else if (e.key === ',' || e.key === '.') set_row(state.row + (e.key === '.' ? 1 : -1));
      else if (e.key === 'PageUp' || e.key === 'PageDown') step_strip(e.key === 'PageDown' ? 1 : -1);
      else if (e.key === 'Home') set_row(0);
      else if (e.key === 'End' || e.key === 'u') set_row(rows);
      else if (e.key === 'Escape') { if (state.chosen >= 0) choose(state.chosen, true); }
      else return;
      e.preventDefault();
    });

    // One pointer turns (with a second button or shift: moves), two move and zoom; a press without a way picks.
    const pointers = new Map();
    let moved = 0;
    canvas.addEventListener('pointerdown', (e) => {
      canvas.setPointerCapture(e.pointerId); pointers.set(e.pointerId, [e.clientX, e.clientY]);
      if (pointers.size === 1) moved = 0;
      stage.focus({ preventScroll: true });
    });
    canvas.addEventListener('pointermove', (e) => {
      const last = pointers.get(e.pointerId);
      if (!last) return;
      const dx = e.clientX - last[0], dy = e.clientY - last[1];
      const gap = () => { const [a, b] = [...pointers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]) || 1; };
      moved += Math.abs(dx) + Math.abs(dy);
      if (pointers.size === 2) {
        const before = gap();
        pointers.set(e.pointerId, [e.clientX, e.clientY]);
        pan(dx / 2, dy / 2); zoom(before / gap());
        return;
      }
      pointers.set(e.pointerId, [e.clientX, e.clientY]);
      if (moved < 4) return;
      if (e.shiftKey || e.buttons & 6) pan(dx, dy); else turn(dx * 0.008, dy * 0.008);
    });
    const release = (e) => {
      if (pointers.delete(e.pointerId) && e.type === 'pointerup' && moved < 4 && rows) {
        const box = canvas.getBoundingClientRect();
        const strip = strip_at(e.clientX - box.left - box.width / 2, box.top + box.height / 2 - e.clientY);
        if (strip >= 0 || state.chosen >= 0) choose(strip >= 0 ? strip : state.chosen, true);
      }
    };
    canvas.addEventListener('pointerup', release);
    canvas.addEventListener('pointercancel', release);
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
    canvas.addEventListener('wheel', (e) => {
      // The wheel is the page's until the view has been touched or has the focus.
      if (document.activeElement !== stage && !e.ctrlKey) return;
      e.preventDefault();
      const box = canvas.getBoundingClientRect();
      zoom(Math.exp(Math.max(-60, Math.min(60, e.deltaY)) * 0.003), e.clientX - box.left - box.width / 2, box.top + box.height / 2 - e.clientY);
    }, { passive: false });
    new ResizeObserver(() => draw()).observe(canvas);

    root.classList.add('live');
    root.dataset.state = 'webgl2';
    root.dataset.triangles = cut_triangles + design_triangles;
    set_color(state.color); set_row(rows); set_clip(-1); view('i'); legend();
    requestAnimationFrame(() => { root.dataset.ready_ms = (performance.now() - began).toFixed(0); });
  }

  if (typeof DecompressionStream === 'undefined') return still(say('this browser is too old'));
  unpacked(data.textContent).then(parsed).then(start).catch((error) => still(error.message));
})();
