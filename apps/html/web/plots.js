// σ over the iterations of a search, and over the joints.
import {element, text} from './dom.js';

const WIDTH = 600, HEIGHT = 170, LEFT = 62, BOTTOM = 24, TOP = 8;

// Where iteration k of `count` is in the plot.
const place = (k, count) => LEFT + (WIDTH - LEFT - 8) * k / Math.max(1, count - 1);

// A line for each descent; filled: free. `go(k)` is what a click on iteration k does, if `frames`, the places of the slider, have it.
export function plotSigma(svg, iterations, frames, go) {
  svg.replaceChildren();
  const sigmas = iterations.map((it) => it.sigma).filter((sigma) => sigma > 0);
  if (sigmas.length === 0) return;
  const low = Math.log10(Math.min(...sigmas)), high = Math.max(low + 0.1, Math.log10(Math.max(...sigmas)));
  const x = (k) => place(k, iterations.length);
  const y = (sigma) => TOP + (HEIGHT - TOP - BOTTOM) * (high - Math.log10(Math.max(sigma, 10 ** low))) / (high - low);
  const add = (tag, attributes, content, parent = svg) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    if (content) made.textContent = content;
    parent.append(made);
    return made;
  };
  for (const sigma of [10 ** high, 10 ** low]) {
    add('line', {x1: LEFT, x2: WIDTH, y1: y(sigma), y2: y(sigma), class: 'grid'});
    add('text', {x: LEFT - 4, y: y(sigma) + 4, 'text-anchor': 'end'}, text(Number(sigma.toPrecision(2))));
  }
  add('text', {x: LEFT, y: HEIGHT - 6}, 'iteration 1');
  add('text', {x: WIDTH - 4, y: HEIGHT - 6, 'text-anchor': 'end'}, String(iterations.length));
  for (let begin = 0, end; begin < iterations.length; begin = end) {
    for (end = begin; end < iterations.length && iterations[end].descent === iterations[begin].descent; ++end);
    const points = iterations.slice(begin, end).map((it, k) => `${x(begin + k)},${y(it.sigma)}`);
    add('polyline', {points: points.join(' '), class: 'descent'});
  }
  const reachable = new Map(frames.map(({iteration}, frame) => [iteration, frame]));
  iterations.forEach((it, k) => {
    const dot = add('circle', {cx: x(k), cy: y(it.sigma), r: it.free ? 3.2 : 2.4, class: it.free ? 'free' : 'overlaps'});
    add('title', {}, `${it.start}, step ${it.step}: sigma ${text(it.sigma)} m², ${it.free ? 'free' : 'overlaps'}`, dot);
    if (!reachable.has(k)) return;
    dot.classList.add('reachable');
    dot.onclick = () => go(reachable.get(k));
  });
  add('line', {y1: TOP, y2: HEIGHT - BOTTOM, class: 'shown', visibility: 'hidden'});
}

// Marks the iteration that the slider shows; -1: none.
export function markIteration(svg, k, count) {
  const line = svg.lastElementChild;
  if (!line) return;
  line.setAttribute('visibility', k < 0 ? 'hidden' : 'visible');
  for (const end of ['x1', 'x2']) line.setAttribute(end, place(k, count));
}

// Joints in one frame: {name, unit, moved, sigma}, the last two with a number for each frame. Bars are as long as σ of the joint is
// large, against the largest in any frame.
export function fillJoints(body, joints, frame) {
  const most = Math.max(...joints.flatMap((joint) => joint.sigma), 1e-300);
  body.replaceChildren(...joints.map(({name, unit, moved, sigma}) => {
    const row = element('tr'), cell = element('td');
    const bar = element('div', undefined, {class: 'bar', style: `width:${100 * sigma[frame] / most}%`});
    cell.append(bar);
    row.append(element('td', name), element('td', moved && `${text(moved[frame])} ${unit}`), element('td', text(sigma[frame])), cell);
    return row;
  }));
}
