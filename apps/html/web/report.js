// What a report does: unpacks a row when it is chosen, fills the page, moves the slider. Data come from apps/html/page.cc.
import {$, fill, fillTables, mark, onCopy} from './dom.js';
import {unpackRow} from './packed.js';
import {fillJoints, plotJoints, plotSigma} from './plots.js';
import {RowList} from './rows.js';
import {Stage} from './stage.js';

const page = JSON.parse($('page').textContent);
let stage, list, row, frame = 0, begun, marks = [];

// Writes what the page says of a place of the slider.
function writeFrame(k) {
  frame = Math.max(0, Math.min(row.frames.length - 1, k));
  const {label, iteration} = row.frames[frame];
  const words = (k) => `'${row.q(k).join(' ')}'`;
  $('norm').textContent = row.norm ? `${row.norm} --from ${words(0)} --to ${words(frame)} --json -` : '';
  $('slider').value = frame;
  $('slider').setAttribute('aria-valuetext', label);
  $('frame').textContent = label;
  fillJoints($('joints'), row.joints ?? [], frame);
  marks.forEach((mark) => mark({iteration, frame}));
}

function showFrame(k) {
  if (row.frames.length === 0) return;
  writeFrame(k);
  stage.showFrame(frame);
}

// The plots of a row; `marks` show in them where the slider is.
function drawPlots() {
  const {iterations = [], joints = [], frames} = row, several = joints.length > 0 && frames.length > 2;  // two places make no line
  const searched = iterations.some((it) => it.sigma > 0);
  marks = [];
  showSection('sigma', searched);
  showSection('joint-lines', several);
  if (searched) {
    const mark = plotSigma($('sigma'), iterations, frames, showFrame);
    marks.push((place) => mark(place.iteration));
  }
  if (several) {
    const mark = plotJoints($('joint-lines'), $('joint-names'), row, showFrame);
    marks.push((place) => mark(place.frame));
  }
}

// A section is there if its table or plot has something.
function showSection(id, filled) {
  $(id).closest('section').hidden = !filled;
}

const CONTACTS = ['contacts_in', 'contacts', 'contacts_goal', 'contacts_stop'];

function fillContacts(id) {
  const contacts = row[id] ?? [];
  const cells = (c) => [c.geom1, c.geom2, -1e3 * c.distance, c.normal.map((n) => (Math.round(100 * n) / 100 || 0).toFixed(2)).join(' ')];
  showSection(id, contacts.length);
  fill($(id), contacts.map(cells), (k) => {
    CONTACTS.filter((other) => other !== id).forEach((other) => mark($(other), -1));
    showFrame({contacts_in: 0, contacts_stop: row.opens}[id] ?? row.frames.length - 1);
    stage.lookAtContact(contacts[k]);
    document.body.dataset.contact = k;
  });
}

function fillPage() {
  const {label, status, model} = page.rows[list.current];
  $('title').textContent = status === 'motion' ? label : `${label}: ${status.replaceAll('_', ' ')}`;
  $('model').textContent = page.models[model];
  fill($('facts'), row.facts ?? []);
  $('reason').textContent = row.reason ?? '';
  showSection('facts', row.facts?.length || row.reason || row.command);
  CONTACTS.forEach(fillContacts);
  fillTables($('row-tables'), row.tables, page.note, showFrame);
  showSection('joints', row.joints?.length);
  drawPlots();
  $('command').textContent = row.command ?? '';
  $('trace').textContent = row.trace ?? '';
  $('stop').textContent = row.stop ?? '';
  $('note').textContent = row.note ?? '';
  $('command-part').hidden = !row.command;
  $('norm-part').hidden = !row.norm;
}

function showScene(bodies) {
  const several = row.frames.length > 1;
  $('nothing').hidden = row.frames.length > 0;
  $('slider').hidden = $('after').hidden = !several;
  document.querySelectorAll('.motion').forEach((label) => { label.hidden = !several; });
  $('before').textContent = several ? row.before ?? 'as given' : 'what overlaps';
  $('ghost-words').textContent = row.before ?? 'as given';
  if (!bodies) return stage.clear();
  $('slider').max = row.frames.length - 1;
  $('ghost').checked = true;
  writeFrame(row.opens ?? row.frames.length - 1);  // before, as it may need more lines
  stage.setRow(bodies, row, frame);
}

async function choose(index) {
  list.mark(index);
  const next = await unpackRow(index);
  const bodies = next.frames.length > 0 ? await stage.bodiesOf(page.rows[index].model) : undefined;
  if (index !== list.current) return;
  row = next;
  fillPage();
  showScene(bodies);
  document.body.dataset.row = index;
}

async function drawThumbnail(index, canvas) {
  await begun;  // what is looked at comes first
  const other = await unpackRow(index);
  if (other.frames.length > 0) stage.thumbnail(await stage.bodiesOf(page.rows[index].model), other, canvas);
}

function setDark(dark) {
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  stage.background(dark ? 0x16191d : 0xf4f5f7);
}

const toggle = (id) => { $(id).checked = !$(id).checked; $(id).onchange(); };
const keys = {
  ArrowLeft: () => showFrame(frame - 1), ArrowRight: () => showFrame(frame + 1), Home: () => showFrame(0), End: () => showFrame(row.frames.length - 1),
  n: () => list.step(1), p: () => list.step(-1), g: () => toggle('ghost'), s: () => toggle('beside'), c: () => toggle('colliding'),
  d: () => $('dark').click(), f: () => stage.lookAtAll(), '/': () => $('filter').focus(),
};

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (/INPUT|SELECT/.test(event.target.tagName) && event.target.type !== 'checkbox') {
    if (event.key === 'Escape') event.target.blur();
    if (event.target.id !== 'slider') return;
  }
  if (!keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
}

// A whole motion, else the first row that is bad news, else the first that was moved.
function firstRow() {
  const first = (wanted) => page.rows.findIndex(wanted);
  return [first((one) => one.status === 'motion'), first((one) => one.wrong), first((one) => one.status === 'solved'), 0].find((k) => k >= 0);
}

async function begin() {
  stage = new Stage($('canvas'));
  stage.resize();
  setDark(window.matchMedia('(prefers-color-scheme: dark)').matches);
  $('slider').oninput = () => showFrame(Number($('slider').value));
  $('ghost').onchange = () => stage.showGhost($('ghost').checked);
  $('beside').onchange = () => stage.showBeside($('beside').checked);
  $('colliding').onchange = () => stage.showColliding($('colliding').checked);
  $('dark').onclick = () => setDark(document.documentElement.dataset.theme !== 'dark');
  document.querySelectorAll('.copy').forEach(onCopy);
  document.onkeydown = onKey;
  fillTables($('page-tables'), page.tables, page.note);
  $('again').textContent = page.again;
  $('again-note').textContent = page.note;
  $('again-part').hidden = !page.again;
  fill($('options'), page.options);
  showSection('options', page.options.length);
  $('versions').textContent = page.versions;
  list = new RowList(page, choose, drawThumbnail);
  const asked = new URLSearchParams(window.location.hash.slice(1));  // #row=3&frame=5, or frame=50%
  begun = choose(page.rows[asked.get('row')] ? Number(asked.get('row')) : firstRow());
  await begun;
  window.onresize = () => { drawPlots(); if (row.frames.length > 0) writeFrame(frame); };
  const at = asked.get('frame');
  if (at) showFrame(Math.round(at.endsWith('%') ? parseFloat(at) / 100 * (row.frames.length - 1) : Number(at)) || 0);
  document.body.dataset.ready = 'yes';
}

begin().catch((error) => {
  console.error(error);
  $('title').textContent = `This report cannot be shown: ${error.message}`;
});
