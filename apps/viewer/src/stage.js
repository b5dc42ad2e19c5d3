// SPDX-License-Identifier: MIT
//
// stage.js: the canvas, the camera and when to draw: only when something changed, with fewer curves while it moves if
// the machine is slow.
import { Color, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

const ups = [new Vector3(0, 1, 0), new Vector3(0, 0, 1), new Vector3(1, 0, 0)];

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: 'high-performance', preserveDrawingBuffer: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.01, 100);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = !matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => { this.moving = true; });
    this.controls.addEventListener('end', () => { this.moving = false; this.draw(); });
    this.layers = [];  // have resize(width, height, ratio) and detail(fraction)
    this.up = 0;
    this.reach = 0;  // from the middle to the farthest point, in diagonals
    this.cost = 0;
    this.moving = false;
    this.hasty = false;  // large surfaces are drawn coarsely while they are being opened
    this.waiting = [];   // to be told when the next picture is drawn
    new ResizeObserver(() => this.resize()).observe(canvas);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => this.theme());
    this.theme();
  }

  theme() {
    const style = getComputedStyle(document.documentElement);
    this.scene.background = new Color(style.getPropertyValue('--canvas').trim());
    for (const l of this.layers) l.theme?.(style);
    this.draw();
  }

  add(layer) {
    this.layers.push(layer);
    this.scene.add(layer.object);
    layer.resize?.(this.width, this.height, this.ratio);
    layer.theme?.(getComputedStyle(document.documentElement));
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.ratio = Math.min(window.devicePixelRatio, 2);
    this.width = width;
    this.height = height;
    this.camera.aspect = width / height;
    this.aim();
    this.draws(this.ratio);
    this.draw();
  }

  /** Leaves room for the panel: the middle of the picture is the middle of what is free. */
  aim() {
    const phone = this.width < 760;
    const panel = document.querySelector('.panel');
    const free = { x: 0, y: 0 };
    if (panel && !phone) free.x = panel.getBoundingClientRect().width + 24;
    else if (panel) free.y = Math.min(panel.getBoundingClientRect().height, 170);
    this.camera.setViewOffset(this.width, this.height, free.x / 2, free.y / 2, this.width, this.height);
    this.free = { width: this.width - free.x, height: this.height - free.y };
    this.camera.updateProjectionMatrix();
  }

  /** The widest picture that this machine draws at once, in pixels. */
  get widest() {
    const { capabilities } = this.renderer, gl = this.renderer.getContext();
    const [x, y] = gl.getParameter(gl.MAX_VIEWPORT_DIMS).map((d) => Math.min(d, capabilities.maxTextureSize));
    return Math.floor(Math.min(x, (y * this.width) / this.height));
  }

  /** Width and height of a picture of about this width, in pixels. */
  pictureSize(width) {
    const ratio = Math.min(width, this.widest) / this.width + 1e-6 / this.width;
    return { ratio, size: [this.width, this.height].map((d) => Math.floor(d * ratio)) };
  }

  /** What is on screen as a PNG, so many pixels wide; no wider than `widest`. */
  async picture(width) {
    this.draws(this.pictureSize(width).ratio);
    this.renderer.render(this.scene, this.camera);
    const blob = await new Promise((done) => this.canvas.toBlob(done, 'image/png'));
    this.resize();
    return blob;
  }

  /** So many pixels of the picture to one of the page. */
  draws(ratio) {
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(this.width, this.height, false);
    for (const l of this.layers) l.resize?.(this.width, this.height, ratio);
  }

  /** Looks at everything from a three-quarter view. */
  frame(diagonal) {
    this.diagonal = diagonal;
    this.camera.near = diagonal * 1e-3;
    this.camera.far = diagonal * 20;
    const shape = Math.min(this.free.width / this.width * this.camera.aspect, this.free.height / this.height);
    const distance = (Math.max(0.41, 1.05 * (this.reach || 0)) * diagonal) / Math.tan((this.camera.fov * Math.PI) / 360) / Math.min(shape, 0.95);
    const y = ups[this.up], x = ups[(this.up + 2) % 3], z = ups[(this.up + 1) % 3];
    const towards = new Vector3().addScaledVector(x, 0.42).addScaledVector(y, 0.26).addScaledVector(z, 0.87).normalize();
    this.camera.up.copy(y);
    this.controls.object = this.camera;
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(towards.multiplyScalar(distance));
    this.controls.minDistance = diagonal * 0.02;
    this.controls.maxDistance = diagonal * 10;
    // The controls keep a turned coordinate system for the axis that was up when they were made.
    this.controls._quat?.setFromUnitVectors(this.camera.up, new Vector3(0, 1, 0));
    this.controls._quatInverse?.copy(this.controls._quat).invert();
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  cycleUp() {
    this.up = (this.up + 1) % 3;
    this.frame(this.diagonal);
  }

  turn(dx, dy) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    offset.applyAxisAngle(this.camera.up, dx);
    const side = new Vector3().crossVectors(this.camera.up, offset).normalize();
    const tilted = offset.clone().applyAxisAngle(side, dy);
    const angle = tilted.angleTo(this.camera.up);
    this.camera.position.copy(this.controls.target).add(angle > 0.1 && angle < Math.PI - 0.1 ? tilted : offset);
    this.controls.update();
    this.draw();
  }

  zoom(factor) {
    const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  draw() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      const moving = this.controls.update() || this.moving;  // asks for the next frame while it glides
      const detail = this.hasty ? 0.25 : moving && this.cost > 40 ? Math.max(0.25, 30 / this.cost) : 1;
      for (const l of this.layers) l.detail?.(detail);
      this.before?.();
      const start = performance.now();
      this.renderer.render(this.scene, this.camera);
      if (detail === 1) this.cost = performance.now() - start;
      else if (!this.moving && !this.hasty) this.draw();  // in full, when nothing moves any more
      for (const tell of this.waiting.splice(0)) tell(performance.now());
    });
  }

  /** Resolves to the time when what has changed by now is drawn. */
  drawn() {
    this.draw();
    return new Promise((tell) => this.waiting.push(tell));
  }

  /** The same, but in a page that nobody sees, where nothing is drawn, after a second. */
  seen() {
    return Promise.race([this.drawn().then(() => new Promise(requestAnimationFrame)), new Promise((go) => setTimeout(go, 1000))]);
  }
}
