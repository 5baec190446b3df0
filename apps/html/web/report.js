// What a report does: unpacks a row when it is chosen, fills the page, moves the slider. Data come from apps/html/solve_page.cc.
import {Stage} from './stage.js';

const $ = (id) => document.getElementById(id);
const text = (value) => (typeof value === 'number' ? Number(value.toPrecision(4)).toString() : value);

// A packed block: length of a JSON text, the text, then numbers; deflated, in base64.
async function unpack(id) {
  const packed = Uint8Array.from(atob($(id).textContent.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = await new Response(stream).arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  return {json: JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))), bytes: bytes.slice(4 + length)};
}

function element(tag, content, attributes = {}) {
  const made = document.createElement(tag);
  if (content !== undefined) made.textContent = content;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

function table(body, rows, choose) {
  body.replaceChildren(...rows.map((cells, k) => {
    const row = element('tr');
    cells.forEach((cell) => row.append(element('td', text(cell))));
    if (choose) {
      row.tabIndex = 0;
      row.onclick = () => choose(k);
      row.onkeydown = (event) => { if (event.key === 'Enter') choose(k); };
    }
    return row;
  }));
}

// σ of every iteration, a line for each descent; filled: free.
function plotSigma(svg, iterations) {
  const width = 600, height = 170, left = 62, bottom = 24, top = 8;
  const sigmas = iterations.map((it) => it.sigma).filter((sigma) => sigma > 0);
  svg.replaceChildren();
  if (sigmas.length === 0) return;
  const low = Math.log10(Math.min(...sigmas)), high = Math.max(low + 0.1, Math.log10(Math.max(...sigmas)));
  const x = (k) => left + (width - left - 8) * k / Math.max(1, iterations.length - 1);
  const y = (sigma) => top + (height - top - bottom) * (high - Math.log10(Math.max(sigma, 10 ** low))) / (high - low);
  const add = (tag, attributes, content) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    if (content) made.textContent = content;
    svg.append(made);
    return made;
  };
  for (const sigma of [10 ** high, 10 ** low]) {
    add('line', {x1: left, x2: width, y1: y(sigma), y2: y(sigma), class: 'grid'});
    add('text', {x: left - 4, y: y(sigma) + 4, 'text-anchor': 'end'}, text(Number(sigma.toPrecision(2))));
  }
  add('text', {x: left, y: height - 6}, 'iteration 1');
  add('text', {x: width - 4, y: height - 6, 'text-anchor': 'end'}, String(iterations.length));
  for (let begin = 0, end; begin < iterations.length; begin = end) {
    for (end = begin; end < iterations.length && iterations[end].descent === iterations[begin].descent; ++end);
    const points = iterations.slice(begin, end).map((it, k) => `${x(begin + k)},${y(it.sigma)}`);
    add('polyline', {points: points.join(' '), class: 'descent'});
  }
  iterations.forEach((it, k) => {
    const dot = add('circle', {cx: x(k), cy: y(it.sigma), r: it.free ? 3.2 : 2.4, class: it.free ? 'free' : 'overlaps'});
    dot.append(document.createElementNS('http://www.w3.org/2000/svg', 'title'));
    dot.firstChild.textContent = `${it.start}, step ${it.step}: sigma ${text(it.sigma)} m², ${it.free ? 'free' : 'overlaps'}`;
  });
}

function bars(body, joints) {
  const most = Math.max(...joints.map((joint) => joint.share), 1e-300);
  body.replaceChildren(...joints.map((joint) => {
    const row = element('tr');
    row.append(element('td', joint.name), element('td', `${text(joint.moved)} ${joint.unit}`), element('td', `${text(joint.share)} %`));
    const bar = element('div', undefined, {class: 'bar', style: `width:${100 * joint.share / most}%`});
    row.append(element('td'));
    row.lastChild.append(bar);
    return row;
  }));
}

const page = JSON.parse($('page').textContent);
let stage, row, shown = [], current = -1, frame = 0;

function showFrame(k) {
  frame = Math.max(0, Math.min(row.frames.length - 1, k));
  $('slider').value = frame;
  $('frame').textContent = row.frames[frame];
  $('slider').setAttribute('aria-valuetext', row.frames[frame]);
  stage.showFrame(frame);
}

async function choose(index) {
  current = index;
  const {json, bytes} = await unpack(`row${index}`);
  if (index !== current) return;
  row = json;
  const summary = page.rows[index];
  stage.setRow(new Float32Array(bytes), row.contacts_in);
  $('slider').max = row.frames.length - 1;
  $('title').textContent = `${summary.label}: ${summary.status.replace('_', ' ')}`;
  table($('facts'), row.facts);
  $('reason').textContent = row.reason;
  $('command').textContent = row.command;
  table($('contacts'), row.contacts_in.map((c) => [c.geom1, c.geom2, -1e3 * c.distance, c.normal.map((n) => n.toFixed(2)).join(' ')]), (k) => {
    stage.lookAtContact(row.contacts_in[k]);
    [...$('contacts').children].forEach((line, j) => line.classList.toggle('chosen', j === k));
    document.body.dataset.contact = k;
  });
  bars($('joints'), row.joints);
  plotSigma($('sigma'), row.iterations);
  showFrame(row.frames.length - 1);
  [...$('rows').children].forEach((line) => line.classList.toggle('chosen', Number(line.dataset.index) === index));
  document.body.dataset.row = index;
}

// Lines of the list are made as it is scrolled: there may be many thousands.
function listMore(count) {
  const begin = $('rows').children.length;
  for (const index of shown.slice(begin, begin + count)) {
    const {label, status, depth, rms} = page.rows[index];
    const line = element('tr', undefined, {tabindex: 0, 'data-index': index, class: status});
    for (const cell of [index, label, status.replace('_', ' '), depth, rms]) line.append(element('td', text(cell)));
    line.onclick = () => choose(index);
    line.onkeydown = (event) => { if (event.key === 'Enter') choose(index); };
    line.classList.toggle('chosen', index === current);
    $('rows').append(line);
  }
}

function list() {
  const words = $('filter').value.toLowerCase().split(/\s+/).filter(Boolean);
  const key = $('sort').value, sign = key === 'index' || key === 'label' ? 1 : -1;
  const value = (index) => (key === 'index' ? index : page.rows[index][key]);
  shown = page.rows.map((_, index) => index).filter((index) => {
    const line = `${index} ${page.rows[index].label} ${page.rows[index].status.replace('_', ' ')}`.toLowerCase();
    return words.every((word) => line.includes(word));
  });
  shown.sort((a, b) => sign * (value(a) < value(b) ? -1 : value(a) > value(b) ? 1 : 0) || a - b);
  $('rows').replaceChildren();
  $('count').textContent = `${shown.length} of ${page.rows.length}`;
  listMore(100);
}

function step(by) {
  const at = shown.indexOf(current) + by;
  if (at >= 0 && at < shown.length) choose(shown[at]);
}

function setDark(dark) {
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  stage.background(dark ? 0x16191d : 0xf4f5f7);
}

const toggle = (id) => { $(id).checked = !$(id).checked; $(id).onchange(); };
const keys = {
  ArrowLeft: () => showFrame(frame - 1), ArrowRight: () => showFrame(frame + 1), Home: () => showFrame(0), End: () => showFrame(row.frames.length - 1),
  n: () => step(1), p: () => step(-1), g: () => toggle('ghost'), c: () => toggle('colliding'), d: () => $('dark').click(), f: () => stage.lookAtAll(), '/': () => $('filter').focus(),
};

async function begin() {
  const {json, bytes} = await unpack('scene');
  stage = new Stage($('canvas'), json, bytes);
  stage.resize();
  setDark(window.matchMedia('(prefers-color-scheme: dark)').matches);
  $('slider').oninput = () => showFrame(Number($('slider').value));
  $('ghost').onchange = () => stage.showGhost($('ghost').checked);
  $('colliding').onchange = () => stage.showGroups($('colliding').checked);
  $('dark').onclick = () => setDark(document.documentElement.dataset.theme !== 'dark');
  $('copy').onclick = () => navigator.clipboard?.writeText($('command').textContent);
  $('filter').oninput = list;
  $('sort').onchange = list;
  $('list').onscroll = () => { if ($('list').scrollTop + $('list').clientHeight > $('list').scrollHeight - 200) listMore(100); };
  document.onkeydown = (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (/INPUT|SELECT/.test(event.target.tagName) && event.target.type !== 'checkbox') {
      if (event.key === 'Escape') event.target.blur();
      if (event.target.id !== 'slider' || event.key.startsWith('Arrow')) return;
    }
    if (keys[event.key]) { event.preventDefault(); keys[event.key](); }
  };
  $('list-part').hidden = page.rows.length < 2;
  list();
  const first = page.rows.findIndex((one) => one.status !== 'already_free');
  await choose(Math.max(0, first));
  document.body.dataset.ready = 'yes';
}

begin().catch((error) => { $('title').textContent = `This report cannot be shown: ${error.message}`; });
