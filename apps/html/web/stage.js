// The scene in 3-D: bodies, contacts as arrows along their normals, the camera.
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {AFTER, BEFORE, Bodies, CONTACT} from './bodies.js';
import {unpack} from './packed.js';

const THUMB = [64, 48];    // pixels of a thumbnail

function arrows(contacts, colour, size) {
  const group = new THREE.Group();
  for (const contact of contacts) {
    const length = Math.max(2 * size, -contact.distance), head = Math.min(size, 0.4 * length);
    const material = new THREE.MeshBasicMaterial({color: colour, depthTest: false, transparent: true});  // drawn last
    const arrow = new THREE.Group();
    for (const geometry of [new THREE.SphereGeometry(0.2 * size, 12, 8),
      new THREE.CylinderGeometry(0.08 * size, 0.08 * size, length - head, 8).translate(0, 0.5 * (length - head), 0),
      new THREE.ConeGeometry(0.4 * head, head, 12).translate(0, length - 0.5 * head, 0)]) {
      const part = new THREE.Mesh(geometry, material);
      part.renderOrder = 1;
      arrow.add(part);
    }
    arrow.userData = {contact, material};
    const along = new THREE.Vector3(...contact.normal);
    arrow.position.set(...contact.position).addScaledVector(along, -0.5 * length);  // the contact is in the middle of its two points
    arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along);
    group.add(arrow);
  }
  return group;
}

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
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
    this.marks = new THREE.Group();
    this.world.add(this.marks);
    this.models = new Map();  // promises of Bodies, made when a row of theirs is first seen
    this.beside = this.colliding = false;
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  bodiesOf(model) {
    if (!this.models.has(model)) {
      this.models.set(model, unpack(`scene${model}`).then(({json, bytes}) => new Bodies(json, bytes, this.colliding)));
    }
    return this.models.get(model);
  }

  // Shows a row, {poses, contacts_in, contacts, ...}, which opens at this frame.
  setRow(bodies, row, frame) {
    this.view = {bodies, row, opened: frame, frame, ghost: true, focus: undefined};
    this.apply(this.view);
    this.lookAtAll();
  }

  clear() {
    this.view = undefined;
    this.draw();
  }

  // Puts what a view has into the world.
  apply(view) {
    const {bodies, row, opened, frame, ghost, focus, hiding = new Set()} = view;
    if (this.bodies) this.world.remove(this.bodies.group);
    this.bodies = bodies;
    this.world.add(bodies.group);
    const {contacts_in: given = [], contacts: found = [], contacts_goal: goal = [], contacts_stop: stop = []} = row;
    bodies.setRow(row, opened);
    bodies.showFrame(frame);
    bodies.showGhost(ghost);
    bodies.focus(focus);
    bodies.seeThrough(hiding);
    this.marks.traverse((part) => { part.geometry?.dispose(); part.material?.dispose(); });
    this.marks.clear();
    const size = 0.04 * bodies.bounds.radius;
    [this.given, this.found, this.goal, this.stop] = [[given, CONTACT], [found, AFTER], [goal, CONTACT], [stop, CONTACT]].map(
      ([contacts, colour]) => arrows(contacts, colour, size));
    this.marks.add(this.given, this.found, this.goal, this.stop);
    this.showArrows(view);
  }

  // Those of the answer, of a path's goal and of where a motion stops, where the slider shows it; one that is looked at stands out.
  showArrows({row, opened, frame, contact}) {
    this.found.visible = this.goal.visible = frame === row.frames.length - 1;
    this.stop.visible = frame === opened;
    for (const {userData} of this.marks.children.flatMap((group) => group.children)) {
      userData.material.opacity = !contact || userData.contact === contact ? 1 : 0.2;
    }
  }

  showFrame(frame) {
    this.view.frame = frame;
    this.bodies.showFrame(frame);
    this.showArrows(this.view);
    this.draw();
  }

  showGhost(on) {
    if (!this.view) return;
    this.view.ghost = on;
    this.bodies.showGhost(on);
    this.draw();
  }

  showColliding(on) {
    this.colliding = on;  // for models that are made later
    this.models.forEach((made) => made.then((bodies) => { bodies.showColliding(on); this.draw(); }));
  }

  // The configuration as given at the left, what the slider shows at the right.
  showBeside(on) {
    this.beside = on;
    this.resize();
    this.lookAtAll();
  }

  lookAtAll() {
    if (!this.view) return;
    this.focus(undefined);
    const {center, radius} = this.bodies.bounds;
    this.look(center, 3.4 * radius, this.bodies.pointsToSee());
  }

  lookAtContact(contact) {
    this.focus(contact.geoms, contact);
    const near = Math.max(this.bodies.radiusAround(contact.geoms), -0.4 * contact.distance), far = 1.2 * this.bodies.bounds.radius;
    const position = new THREE.Vector3(...contact.position);
    this.look(position, near > 0 ? Math.min(Math.max(far, -2 * contact.distance), 5 * near) : far, [position]);
  }

  focus(geoms, contact) {
    Object.assign(this.view, {focus: geoms, contact});
    this.bodies.focus(geoms);
    this.showArrows(this.view);
  }

  // The geoms that hide each of the points from the eye, of those that are `such`.
  hidingEach(points, eye, such) {
    const meshes = [...this.bodies.meshes(this.bodies.now)].filter((mesh) => mesh.visible && such(mesh.userData));
    return points.map((point) => {
      const way = point.clone().sub(eye), far = way.length();
      const ray = new THREE.Raycaster(eye, way.normalize(), 0, far);
      return new Set(ray.intersectObjects(meshes, false).map((hit) => hit.object.userData.geom.id));
    });
  }

  // Where the camera stands: of directions around the target, the one from which fewest of the points are hidden by what has no part in
  // it. What hides those even so is seen through, and so is a wall that hides all that overlaps with it.
  standWhereSeen(target, far, points) {
    let best, hiding, fewest = Infinity;
    for (let k = 0; k < 12 && fewest > 0; ++k) {
      const turn = (k % 2 ? -1 : 1) * Math.ceil(k / 2) * Math.PI / 6 - 0.9;
      const eye = new THREE.Vector3(Math.cos(turn), Math.sin(turn), 0.45).setLength(far).add(target);
      const each = this.hidingEach(points, eye, (geom) => this.bodies.mayHide(geom)), hidden = each.filter((geoms) => geoms.size > 0).length;
      if (hidden < fewest) [best, hiding, fewest] = [eye, each, hidden];
    }
    const [first, ...others] = this.hidingEach(points, best, (geom) => this.bodies.isWall(geom));
    const walls = [...first ?? []].filter((geom) => others.every((geoms) => geoms.has(geom)));
    this.view.hiding = new Set([...hiding.flatMap((geoms) => [...geoms]), ...walls]);
    this.bodies.seeThrough(this.view.hiding);
    return best;
  }

  look(target, distance, points) {
    this.resize();  // the page around may just have changed, and nobody has been told yet
    const far = this.camera.aspect < 1 ? distance / this.camera.aspect : distance;
    this.controls.target.copy(target);
    this.camera.position.copy(this.standWhereSeen(target, far, points));
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
    [this.width, this.height] = [width, height];
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / (this.beside ? 2 : 1) / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.drawNow(); });
  }

  drawNow() {
    if (!this.view) return;
    const {bodies, frame, ghost} = this.view;
    if (!this.beside) return this.drawPart(this.camera, 0, this.width, this.height);
    bodies.showGhost(false);
    bodies.showFrame(0, BEFORE);
    this.found.visible = this.goal.visible = this.stop.visible = false;
    this.drawPart(this.camera, 0, this.width / 2, this.height);
    this.showArrows(this.view);
    this.given.visible = false;
    bodies.showFrame(frame);
    this.drawPart(this.camera, this.width / 2, this.width / 2, this.height);
    this.given.visible = true;
    bodies.showGhost(ghost);
  }

  drawPart(camera, left, width, height) {
    this.renderer.setScissorTest(true);
    this.renderer.setScissor(left, 0, width, height);
    this.renderer.setViewport(left, 0, width, height);
    this.renderer.render(this.world, camera);
  }

  // Draws a row into a small canvas: in a corner of the large one, which is drawn anew before anybody sees it.
  thumbnail(bodies, row, canvas) {
    const opened = row.opens ?? row.frames.length - 1;
    this.apply({bodies, row, opened, frame: opened, ghost: true});
    const {center, radius} = bodies.bounds, [width, height] = THUMB;
    const camera = new THREE.PerspectiveCamera(40, width / height, 1.9 * radius, 200 * radius);  // what is in the way is cut off
    camera.up.set(0, 0, 1);
    camera.position.copy(center).addScaledVector(new THREE.Vector3(0.6, -0.75, 0.45).normalize(), 3 * radius);
    camera.lookAt(center);
    this.drawPart(camera, 0, width, height);
    const scale = this.renderer.getPixelRatio();
    [canvas.width, canvas.height] = [width * scale, height * scale];
    const area = [canvas.width, canvas.height];
    canvas.getContext('2d').drawImage(this.canvas, 0, this.canvas.height - area[1], ...area, 0, 0, ...area);
    if (this.view) this.apply(this.view);
    this.drawNow();
  }
}
