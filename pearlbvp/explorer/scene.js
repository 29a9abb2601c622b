// A view of a surface: turned by dragging, zoomed by the wheel; colours of fields on it.
const VIRIDIS = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];
const BALANCED = ["#08306b", "#2171b5", "#6baed6", "#c6dbef", "#f5f5f2", "#fdd0a2", "#fd8d3c", "#d94801", "#7f2704"];
const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);
const RAMPS = { H: VIRIDIS.map(hex), K: BALANCED.map(hex), u: BALANCED.map(hex) };

/** A colour of a ramp at a share from 0 to 1. */
function shade(ramp, share) {
  const place = Math.min(Math.max(share, 0), 1) * (ramp.length - 1), i = Math.min(Math.floor(place), ramp.length - 2);
  return ramp[i].map((part, k) => part + (place - i) * (ramp[i + 1][k] - part));
}

/** Ends of a field's scale: about 0 for K and u. */
function scaleOf(name, fields) {
  let [low, high] = name === "u" ? [-1, 1] : range(fields.flatMap((field) => [...range(field)]));
  if (name === "K") { high = Math.max(-low, high, 1e-6); low = -high; }
  if (high - low < 1e-5) { low -= 5e-6 + 1e-3 * Math.abs(low); high += 5e-6 + 1e-3 * Math.abs(high); }
  return [low, high];
}

class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.scene = new THREE.Scene();
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -500, 500);
    this.scene.add(new THREE.AmbientLight(0xffffff, 1.5));
    const sun = new THREE.DirectionalLight(0xffffff, 2.2);
    sun.position.set(-0.5, 1, 0.9);
    this.camera.add(sun);
    this.scene.add(this.camera);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.meshes = [];
    this.home();
    new ResizeObserver(() => this.fit()).observe(canvas);
  }

  /** The view at first: from the side, a little from above. */
  home() {
    this.camera.position.set(-25, 35, 90);
    this.camera.zoom = 1;
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.fit();
  }

  /** Show a surface: as many tubes one after another, coloured by a field, in a box of a given size. */
  show(found, tubes, name, ends, box) {
    for (const mesh of this.meshes) { this.scene.remove(mesh); }
    if (this.geometry) { this.geometry.dispose(); this.material.dispose(); }
    this.found = found;
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setIndex(new THREE.BufferAttribute(found.index, 1));
    this.geometry.setAttribute("position", new THREE.BufferAttribute(found.at.slice(), 3));
    this.geometry.setAttribute("normal", new THREE.BufferAttribute(found.normal, 3));
    const field = name === "plain" ? null : found[name], plain = getComputedStyle(document.body).getPropertyValue("--surface").trim();
    if (field) {
      const colours = new Float32Array(3 * field.length), colour = new THREE.Color();
      for (let i = 0; i < field.length; i++) {
        colour.setRGB(...shade(RAMPS[name], (field[i] - ends[0]) / (ends[1] - ends[0])), THREE.SRGBColorSpace);
        colours.set([colour.r, colour.g, colour.b], 3 * i);
      }
      this.geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    }
    this.material = new THREE.MeshStandardMaterial({ vertexColors: Boolean(field), color: field ? "#ffffff" : plain, side: THREE.DoubleSide, roughness: 0.62, metalness: 0.05 });
    this.meshes = Array.from({ length: tubes }, (_, i) => {
      const mesh = new THREE.Mesh(this.geometry, this.material);
      mesh.position.x = found.length * (i - tubes / 2) - this.start(found);
      mesh.frustumCulled = false;
      this.scene.add(mesh);
      return mesh;
    });
    this.box = box;
    this.fit();
  }

  /** Where a surface begins along the axis. */
  start(found) {
    const [low, high] = range(found.at.filter((_, i) => i % 3 === 0));
    return (low + high - found.length) / 2;
  }

  /** Move the surface along its normal by so much of the critical perturbation. */
  move(size) {
    if (!this.found || !this.found.u) return;
    const { at, normal, u } = this.found, moved = this.geometry.attributes.position;
    for (let i = 0; i < at.length; i++) moved.array[i] = at[i] + size * u[Math.floor(i / 3)] * normal[i];
    moved.needsUpdate = true;
    this.geometry.computeVertexNormals();
    if (!size) { this.geometry.attributes.normal.array.set(normal); }
    this.draw();
  }

  /** Fit the box into the canvas. */
  fit() {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!width || !height || !this.box) return;
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.renderer.setSize(width, height, false);
    const half = Math.max(1.03 * this.box[0] + 0.4 * this.box[1], 1.5 * this.box[1] * width / height);
    this.camera.left = -half; this.camera.right = half;
    this.camera.top = half * height / width; this.camera.bottom = -this.camera.top;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() { if (this.box) this.renderer.render(this.scene, this.camera); }
}
