// The scene in 3-D: q_in as an orange ghost, what the slider shows in blue, contacts of q_in as arrows along their normals.
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

// Orange and blue of Okabe and Ito: told apart with every kind of colour vision.
const BEFORE = 0xe69f00, AFTER = 0x0072b2, CONTACT = 0xd55e00;

function meshGeometry(mesh, bytes) {
  const packed = new Uint16Array(bytes, mesh.vertices, 3 * mesh.nv);
  const position = new Float32Array(packed.length);
  for (let k = 0; k < packed.length; ++k) {
    position[k] = mesh.low[k % 3] + (mesh.high[k % 3] - mesh.low[k % 3]) * packed[k] / 65535;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes, mesh.faces, 3 * mesh.nf), 1));
  const flat = geometry.toNonIndexed();  // shaded face by face, as no normals are kept
  flat.computeVertexNormals();
  return flat;
}

function shape(geom, meshes) {
  const [x, y, z] = geom.size;
  switch (geom.type) {
    case 'plane': return new THREE.PlaneGeometry(2 * (x || 10), 2 * (y || 10));
    case 'sphere': return new THREE.SphereGeometry(x, 32, 20);
    case 'capsule': return new THREE.CapsuleGeometry(x, 2 * y, 12, 24).rotateX(Math.PI / 2);
    case 'ellipsoid': return new THREE.SphereGeometry(1, 32, 20).scale(x, y, z);
    case 'cylinder': return new THREE.CylinderGeometry(x, x, 2 * y, 32).rotateX(Math.PI / 2);
    case 'box': return new THREE.BoxGeometry(2 * x, 2 * y, 2 * z);
    default: return meshes[geom.mesh];
  }
}

function place(object, pose, at) {
  object.position.set(pose[at], pose[at + 1], pose[at + 2]);
  object.quaternion.set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
}

export class Stage {
  constructor(canvas, scene, bytes) {
    this.canvas = canvas;
    this.nbody = scene.nbody;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true});
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.001, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.world = new THREE.Scene();
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x666666, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(2, -3, 5);
    this.world.add(sun);
    this.contacts = new THREE.Group();
    this.world.add(this.contacts);
    const meshes = scene.meshes.map((mesh) => meshGeometry(mesh, bytes));
    this.now = this.bodies(scene, meshes, false);
    this.ghost = this.bodies(scene, meshes, true);
    this.showGroups(false);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  bodies(scene, meshes, ghost) {
    const bodies = [];
    for (let b = 0; b < scene.nbody; ++b) bodies.push(new THREE.Group());
    for (const geom of scene.geoms) {
      if (ghost && geom.type === 'plane') continue;
      const material = new THREE.MeshStandardMaterial({
        color: ghost ? BEFORE : new THREE.Color(...geom.rgba.slice(0, 3)),
        roughness: 0.75, side: THREE.DoubleSide, transparent: ghost || geom.rgba[3] < 1,
        opacity: ghost ? 0.4 : Math.max(0.25, geom.rgba[3]), depthWrite: !ghost,
        polygonOffset: ghost, polygonOffsetFactor: 1, polygonOffsetUnits: 4});  // what has not moved is not orange
      const mesh = new THREE.Mesh(shape(geom, meshes), material);
      mesh.userData = {geom, own: material.color.clone()};
      place(mesh, geom.pose, 0);
      bodies[geom.body].add(mesh);
    }
    bodies.forEach((body) => this.world.add(body));
    return bodies;
  }

  // MuJoCo shows groups 0 to 2; what collides is often in a group that it hides.
  showGroups(colliding) {
    for (const body of [...this.now, ...this.ghost]) {
      for (const mesh of body.children) {
        const {geom} = mesh.userData;
        mesh.visible = colliding ? geom.collides : geom.group < 3;
      }
    }
    this.draw();
  }

  // `poses`: frames × nbody × (position, quaternion w x y z); `contacts`: of q_in.
  setRow(poses, contacts) {
    this.poses = poses;
    this.frames = poses.length / (7 * this.nbody);
    const last = 7 * this.nbody * (this.frames - 1);
    this.now.forEach((body, b) => {
      let moved = 0;
      for (let k = 7 * b; k < 7 * b + 7; ++k) moved = Math.max(moved, Math.abs(poses[k] - poses[last + k]));
      const moves = moved > 1e-6;
      this.ghost[b].userData.moves = moves;
      body.children.forEach((mesh) => mesh.material.color.set(moves ? AFTER : mesh.userData.own));
      place(this.ghost[b], poses, 7 * b);
    });
    this.showGhost(true);
    this.showFrame(this.frames - 1);
    this.setContacts(contacts);
    this.lookAtAll();
  }

  showGhost(on) {
    this.ghost.forEach((body) => { body.visible = on && body.userData.moves; });
    this.draw();
  }

  showFrame(frame) {
    this.now.forEach((body, b) => place(body, this.poses, 7 * (this.nbody * frame + b)));
    this.draw();
  }

  setContacts(contacts) {
    this.contacts.clear();
    const size = 0.03 * this.radius();
    for (const contact of contacts) {
      const at = new THREE.Vector3(...contact.position), normal = new THREE.Vector3(...contact.normal);
      const length = Math.max(size * 2, -contact.distance);
      const arrow = new THREE.ArrowHelper(normal, at, length, CONTACT, 0.4 * length, 0.2 * length);
      const ball = new THREE.Mesh(new THREE.SphereGeometry(0.2 * size, 12, 8), new THREE.MeshBasicMaterial({color: CONTACT}));
      ball.position.copy(at);
      [arrow.line, arrow.cone, ball].forEach((part) => { part.material.depthTest = false; part.renderOrder = 1; });
      this.contacts.add(arrow, ball);
    }
  }

  // Of what moves, or of everything: a sphere to look at.
  bounds() {
    const box = new THREE.Box3();
    this.world.updateMatrixWorld(true);
    const add = (moving) => this.now.forEach((body, b) => {
      if (moving && !this.ghost[b].userData.moves) return;
      for (const mesh of body.children) {
        if (mesh.visible && mesh.userData.geom.type !== 'plane') box.expandByObject(mesh);
      }
    });
    add(true);
    if (box.isEmpty()) add(false);
    return box.isEmpty() ? new THREE.Sphere(new THREE.Vector3(), 1) : box.getBoundingSphere(new THREE.Sphere());
  }

  radius() { return this.bounds().radius; }

  lookAtAll() {
    const sphere = this.bounds();
    this.look(sphere.center, 3.4 * sphere.radius);
  }

  lookAtContact(contact) {
    this.look(new THREE.Vector3(...contact.position), 1.2 * this.radius());
  }

  // Of directions around the target, the one from which least that stands still hides it.
  clearDirection(target, far) {
    const still = this.now.filter((_, b) => !this.ghost[b].userData.moves);
    const ray = new THREE.Raycaster();
    let best, fewest = Infinity;
    for (let k = 0; k < 12 && fewest > 0; ++k) {
      const turn = (k % 2 ? -1 : 1) * Math.ceil(k / 2) * Math.PI / 6 - 0.9;
      const direction = new THREE.Vector3(Math.cos(turn), Math.sin(turn), 0.45).normalize();
      ray.set(target.clone().addScaledVector(direction, far), direction.clone().negate());
      ray.far = far;
      const hits = ray.intersectObjects(still).filter((hit) => hit.object.visible).length;
      if (hits < fewest) [best, fewest] = [direction, hits];
    }
    return best;
  }

  look(target, distance) {
    const far = this.camera.aspect < 1 ? distance / this.camera.aspect : distance;
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(this.clearDirection(target, far), far);
    this.camera.near = far / 200;
    this.camera.far = far * 200;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  background(colour) {
    this.world.background = new THREE.Color(colour);
    this.draw();
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas.parentElement;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.renderer.render(this.world, this.camera); });
  }
}
