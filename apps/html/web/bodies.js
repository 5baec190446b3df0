// The bodies of a model: one set that the slider moves, and one at q_in, a ghost, of which only what moves is seen.
import * as THREE from 'three';

// Orange and blue of Okabe and Ito: told apart with every kind of colour vision.
export const BEFORE = 0xe69f00, AFTER = 0x0072b2;
export const CONTACT = 0xd55e00;  // their vermilion
const POSE = 7;  // numbers of a body's pose
const TINY = 0.1;  // of its body's radius: what is so small is not seen, so that its body stands out instead
const POINTS = 8;  // that the camera tries to see
const SUNK = 0.99;  // of its width: what is so deep in another geom is not seen

function meshGeometry(mesh, bytes) {
  const packed = new Uint16Array(bytes, mesh.vertices, 3 * mesh.nv);
  const position = new Float32Array(packed.length);
  for (let k = 0; k < packed.length; ++k) {
    position[k] = mesh.low[k % 3] + (mesh.high[k % 3] - mesh.low[k % 3]) * packed[k] / 65535;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes, mesh.faces, 3 * mesh.nf), 1));
  return geometry;
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

// How far a mesh reaches along a direction of the world [m].
function widthAlong(direction, mesh) {
  const axis = new THREE.Vector3(...direction), at = new THREE.Vector3(), {position} = mesh.geometry.attributes;
  let [low, high] = [Infinity, -Infinity];
  for (let k = 0; k < position.count; ++k) {
    const along = at.fromBufferAttribute(position, k).applyMatrix4(mesh.matrixWorld).dot(axis);
    [low, high] = [Math.min(low, along), Math.max(high, along)];
  }
  return high - low;
}

export class Bodies {
  // `scene` and `bytes`: a block of apps/html/scene_block.cc.
  constructor(scene, bytes, colliding) {
    this.count = scene.nbody;
    const meshes = scene.meshes.map((mesh) => meshGeometry(mesh, bytes));
    this.group = new THREE.Group();
    this.now = this.make(scene, meshes, false);
    this.ghost = this.make(scene, meshes, true);
    this.contacts = this.overlapping = this.stopping = [];
    this.covering = this.hiding = this.tinted = new Set();
    this.showColliding(colliding);
  }

  make(scene, meshes, ghost) {
    const bodies = Array.from({length: this.count}, () => new THREE.Group());
    for (const geom of scene.geoms) {
      if (ghost && geom.type === 'plane') continue;
      const own = new THREE.Color(...geom.rgba.slice(0, 3));
      const material = new THREE.MeshStandardMaterial({
        color: ghost ? BEFORE : own, roughness: 0.75, side: THREE.DoubleSide, flatShading: geom.type === 'mesh',
        polygonOffset: ghost, polygonOffsetFactor: 1, polygonOffsetUnits: 4});  // what has not moved is not orange
      const mesh = new THREE.Mesh(shape(geom, meshes), material);
      mesh.userData = {geom, own, opacity: ghost ? 0.4 : Math.max(0.25, geom.rgba[3])};
      place(mesh, geom.pose, 0);
      bodies[geom.body].add(mesh);
    }
    this.group.add(...bodies);
    return bodies;
  }

  * meshes(bodies = [...this.now, ...this.ghost]) {
    for (const body of bodies) yield* body.children;
  }

  // A row as it is first seen, at frame `opened`. Where nothing has moved in the end, the geoms of its contacts as given stand out.
  setRow({poses, contacts_in: contacts = [], contacts_goal: goal = [], contacts_stop: stop = []}, opened) {
    Object.assign(this, {poses, opened});
    const stride = POSE * this.count;
    this.frames = poses.length / stride;
    this.moves = this.now.map((_, b) => {
      for (let k = stride + POSE * b; k < poses.length; k += stride) {
        for (let j = 0; j < POSE; ++j) if (Math.abs(poses[k + j] - poses[POSE * b + j]) > 1e-6) return true;
      }
      return false;
    });
    const end = stride * (this.frames - 1);
    this.stays = poses.subarray(0, stride).every((x, k) => Math.abs(poses[end + k] - x) < 1e-6);  // as it was in the end
    this.contacts = this.stays ? contacts : [];
    this.overlapping = this.contacts.flatMap((contact) => contact.geoms);
    this.tinted = this.bodiesOf(this.overlapping, (geom) => this.isTiny(geom));
    this.stopping = stop.flatMap((contact) => contact.geoms);
    this.ghost.forEach((body, b) => place(body, poses, POSE * b));
    this.covering = new Set([...this.findCovering(contacts, 0), ...this.findCovering(goal, this.frames - 1)]);
    this.focus();
    this.showGhost(true);
    this.bounds = this.measure();
    this.showFrame(opened);
  }

  showFrame(frame, colour = AFTER) {
    this.frame = frame;
    this.now.forEach((body, b) => {
      place(body, this.poses, POSE * (this.count * frame + b));
      for (const mesh of body.children) {
        const {geom, own} = mesh.userData;
        const stands_out = geom.type !== 'plane' && (this.overlapping.includes(geom.id) || this.tinted.has(geom.body));
        const moved = this.moves[b] && !(this.stays && frame === this.frames - 1);
        const stops = frame === this.opened && this.stopping.includes(geom.id);
        mesh.material.color.set(moved ? (frame === 0 ? BEFORE : colour) : stands_out ? BEFORE : stops ? CONTACT : own);
      }
    });
  }

  showGhost(on) {
    this.ghost.forEach((body, b) => { body.visible = on && this.moves[b]; });
  }

  // What collides instead of what MuJoCo shows.
  showColliding(on) {
    this.colliding = on;
    this.showParts();
    if (this.poses) this.bounds = this.measure();
  }

  // All but these geoms become nearly transparent; without: none.
  focus(geoms) {
    this.focused = geoms;
    this.showParts();
  }

  // Geoms that are in the way of the camera become transparent.
  seeThrough(hiding) {
    this.hiding = hiding;
    this.showParts();
  }

  // Points that the reader wants to see [m]: where contacts are, if nothing has moved, or else the middle of what moved, where it
  // was and where the row opens. A few of many.
  pointsToSee() {
    const middle = (body) => new THREE.Box3().setFromObject(body).getCenter(new THREE.Vector3());
    const bodies = (all) => all.filter((body, b) => this.moves[b] && body.children.length > 0);
    const points = this.contacts.map(({position}) => new THREE.Vector3(...position));
    if (points.length === 0) points.push(...[...bodies(this.ghost), ...bodies(this.now)].map(middle));
    const stride = Math.ceil(points.length / POINTS);
    return points.filter((_, k) => k % stride === 0);
  }

  // Whether the geom is what others overlap with, and cannot move.
  isWall({geom}) {
    return geom.body === 0 && this.overlapping.includes(geom.id);
  }

  // Whether the geom stands still and is no part of what overlaps, so that it may be in the way of the camera.
  mayHide({geom}) {
    return !this.overlapping.includes(geom.id) && !this.stopping.includes(geom.id) && (this.stays || !this.moves[geom.body]);
  }

  // MuJoCo shows groups 0 to 2, and what collides is often in another. What overlaps or is looked at is seen even so, through what
  // else its body has, as what lies wholly in another geom is seen through that.
  showParts() {
    const wanted = [...this.overlapping, ...this.focused ?? []];
    const usual = (geom) => (this.colliding ? geom.collides : geom.group < 3);
    const inside = this.bodiesOf(wanted, (geom) => !usual(geom));
    const stand_for = this.bodiesOf(this.focused ?? [], (geom) => this.isTiny(geom));
    for (const mesh of this.meshes()) {
      const {geom, opacity: own} = mesh.userData, chosen = wanted.includes(geom.id) || (usual(geom) && stand_for.has(geom.body));
      const through = this.covering.has(geom.id) || this.hiding.has(geom.id) || (!chosen && inside.has(geom.body));
      mesh.visible = usual(geom) || chosen;
      const opacity = own * (this.focused && !chosen ? 0.1 : through ? 0.35 : 1);
      Object.assign(mesh.material, {opacity, transparent: opacity < 1, depthWrite: opacity === 1});
    }
  }

  // Geoms that another one is in wholly in this frame: the contact is as deep as that one is wide. Of those that move a ghost is seen
  // through.
  findCovering(contacts, frame) {
    this.showFrame(frame);
    this.group.updateMatrixWorld(true);
    const found = new Map([...this.meshes(this.now)].map((mesh) => [mesh.userData.geom.id, mesh]));
    const covering = new Set();
    for (const {geoms, normal, distance} of contacts) {
      const widths = geoms.map((id) => (found.get(id).userData.geom.type === 'plane' ? Infinity : widthAlong(normal, found.get(id))));
      const outer = geoms[widths[0] > widths[1] ? 0 : 1], still = this.stays || !this.moves[found.get(outer).userData.geom.body];
      if (still && -distance >= SUNK * Math.min(...widths)) covering.add(outer);
    }
    return covering;
  }

  isTiny({body, id}) {
    const radius = ({geometry}) => (geometry.computeBoundingSphere(), geometry.boundingSphere.radius);
    const meshes = this.now[body].children;
    return radius(meshes.find((mesh) => mesh.userData.geom.id === id)) < TINY * Math.max(...meshes.map(radius));
  }

  // The bodies, but for the world, of those of the geoms that are `such`.
  bodiesOf(geoms, such = () => true) {
    const found = [...this.meshes(this.now)].map((mesh) => mesh.userData.geom);
    return new Set(found.filter((geom) => geom.body > 0 && geoms.includes(geom.id) && such(geom)).map((geom) => geom.body));
  }

  // The radius around the bodies of these geoms [m]; 0: they are of the world.
  radiusAround(geoms) {
    const box = new THREE.Box3();
    for (const body of this.bodiesOf(geoms)) {
      for (const mesh of this.now[body].children) if (mesh.visible && mesh.userData.geom.type !== 'plane') box.expandByObject(mesh);
    }
    return box.isEmpty() ? 0 : box.getBoundingSphere(new THREE.Sphere()).radius;
  }

  // A sphere around what moves, as given, where it opens and at the end, or what stands out with its contacts and the bodies it is of, or else around
  // everything.
  measure() {
    const box = new THREE.Box3(), frame = this.frame, bodies = this.bodiesOf(this.overlapping);
    const add = (wanted) => [this.now, this.ghost].forEach((bodies) => bodies.forEach((body, b) => {
      for (const mesh of body.children) {
        const {geom} = mesh.userData;
        if (mesh.visible && geom.type !== 'plane' && wanted(b, geom)) box.expandByObject(mesh);
      }
    }));
    for (const k of [this.opened, this.frames - 1]) {
      this.showFrame(k);
      this.group.updateMatrixWorld(true);
      add((b) => this.moves[b]);
    }
    if (box.isEmpty()) add((b, geom) => bodies.has(b) || this.overlapping.includes(geom.id));
    for (const {position, normal, distance} of this.contacts) {
      for (const half of [-0.5, 0.5]) {
        box.expandByPoint(new THREE.Vector3(...position).addScaledVector(new THREE.Vector3(...normal), half * Math.max(0, -distance)));
      }
    }
    if (box.isEmpty()) add(() => true);
    this.showFrame(frame);
    return box.isEmpty() ? new THREE.Sphere(new THREE.Vector3(), 1) : box.getBoundingSphere(new THREE.Sphere());
  }
}
