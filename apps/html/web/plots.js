// σ over the iterations of a search, and over the joints.
import {element, numberText, text} from './dom.js';

const HEIGHT = 170, LEFT = 62, RIGHT = 8, BOTTOM = 24, TOP = 8;
const LINES = 5;       // of joints in one plot; more cross each other too often, and colours get alike
const ROUND_OFF = 1e-16;  // of the largest σ in a search, or 1e-8 of √σ: what is less is none, and is drawn at the bottom
const DECADES = 1e-3;  // of the largest σ in their plot: what is less is drawn at the bottom

function svgElement(tag, attributes, content) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (content) made.textContent = content;
  return made;
}

// Empties a plot and draws its axes: places 0 to count - 1, of which `ends` says what the first and the last are, and σ from low to high
// on a logarithmic scale. As wide as there is room, so that its words are as large as others. Returns where things are, and what marks a place.
function axes(svg, count, {low, high, ends}) {
  const width = svg.clientWidth, room = Math.max(0, 0.05 - 0.5 * Math.log10(high / low));  // where σ hardly varies
  const [bottom, top] = [Math.log10(low) - room, Math.log10(high) + room];
  svg.setAttribute('viewBox', `0 0 ${width} ${HEIGHT}`);
  svg.replaceChildren();
  const add = (tag, attributes, content) => { svg.append(svgElement(tag, attributes, content)); return svg.lastChild; };
  const x = (k) => LEFT + (width - LEFT - RIGHT) * k / Math.max(1, count - 1);
  const y = (sigma) => TOP + (HEIGHT - TOP - BOTTOM) * (top - Math.log10(Math.max(sigma, low))) / (top - bottom);
  for (const sigma of y(low) - y(high) < 16 ? [high] : [high, low]) {  // two words need so many pixels
    add('line', {x1: LEFT, x2: width, y1: y(sigma), y2: y(sigma), class: 'grid'});
    add('text', {x: LEFT - 4, y: y(sigma) + 4, 'text-anchor': 'end'}, numberText(sigma, 2, 6));
  }
  add('text', {x: LEFT, y: HEIGHT - 6}, ends[0]);
  add('text', {x: width - 4, y: HEIGHT - 6, 'text-anchor': 'end'}, ends[1]);
  const line = add('line', {y1: TOP, y2: HEIGHT - BOTTOM, class: 'shown', visibility: 'hidden'});
  const mark = (k) => {  // -1: none
    line.setAttribute('visibility', k < 0 ? 'hidden' : 'visible');
    for (const end of ['x1', 'x2']) line.setAttribute(end, x(k));
  };
  const placeOf = (event) => Math.round((event.offsetX - LEFT) / (width - LEFT - RIGHT) * (count - 1));
  return {add, x, y, mark, placeOf};
}

// A line for each descent; filled: free. `go(k)` is what a click on iteration k does, if `frames`, the places of the slider, have it.
// Returns what marks an iteration.
export function plotSigma(svg, iterations, frames, go) {
  const most = Math.max(...iterations.map((it) => it.sigma));
  const sigmas = iterations.map((it) => it.sigma).filter((sigma) => sigma > ROUND_OFF * most);
  const {add, x, y, mark} = axes(svg, iterations.length, {
    low: Math.min(...sigmas), high: most, ends: ['iteration 1', String(iterations.length)]});
  for (let begin = 0, end; begin < iterations.length; begin = end) {
    for (end = begin; end < iterations.length && iterations[end].descent === iterations[begin].descent; ++end);
    const points = iterations.slice(begin, end).map((it, k) => `${x(begin + k)},${y(it.sigma)}`);
    add('polyline', {points: points.join(' '), class: 'descent'});
  }
  const reachable = new Map(frames.map(({iteration}, frame) => [iteration, frame]));
  iterations.forEach((it, k) => {
    const dot = add('circle', {cx: x(k), cy: y(it.sigma), r: it.free ? 3.2 : 2.4, class: it.free ? 'free' : 'overlaps'});
    dot.append(svgElement('title', {}, `descent ${it.descent} (${it.start}), step ${it.step}: sigma ${text(it.sigma)} m², ${it.free ? 'free' : 'overlaps'}`));
    if (!reachable.has(k)) return;
    dot.classList.add('reachable');
    dot.onclick = () => go(reachable.get(k));
  });
  return mark;
}

// A line for each of the first joints, those that move most, over the places of the slider, and their names in `legend`. A click goes to
// the place under it. Returns what marks a place.
export function plotJoints(svg, legend, {joints, frames}, go) {
  const shown = joints.slice(0, LINES), most = Math.max(...shown.flatMap((joint) => joint.sigma));
  const {add, x, y, mark, placeOf} = axes(svg, frames.length, {
    low: DECADES * most, high: most, ends: [frames[0].label, frames[frames.length - 1].label]});
  legend.replaceChildren(...shown.map(({name, sigma}, k) => {
    const points = sigma.map((value, frame) => `${x(frame)},${y(value)}`).join(' ');
    add('polyline', {points, class: `joint joint${k}`}).append(svgElement('title', {}, name));
    const item = element('span'), sample = svgElement('svg', {viewBox: '0 0 34 10', 'aria-hidden': true});
    sample.append(svgElement('line', {x1: 0, x2: 34, y1: 5, y2: 5, class: `joint joint${k}`}));
    item.append(sample, name);
    return item;
  }));
  svg.onclick = (event) => go(placeOf(event));
  return mark;
}

// Joints in one frame: {name, unit, moved, sigma}, the last two with a number for each frame. Bars are as long as σ of the joint is
// large, against the largest in this frame.
export function fillJoints(body, joints, frame) {
  const most = Math.max(...joints.map((joint) => joint.sigma[frame]), 1e-300);
  body.replaceChildren(...joints.map(({name, unit, moved, sigma}) => {
    const row = element('tr'), cell = element('td');
    const bar = element('div', undefined, {class: 'bar', style: `width:${100 * sigma[frame] / most}%`});
    cell.append(bar);
    row.append(element('td', name), element('td', moved && `${text(moved[frame])} ${unit}`, {class: 'number'}), element('td', text(sigma[frame]), {class: 'number'}), cell);
    return row;
  }));
}
