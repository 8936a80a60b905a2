// SPDX-License-Identifier: Apache-2.0
// The live page: asks the gateway once a second and draws the map from above, x up and y to the left as on the robot.
"use strict";

const COLOURS = ["#2e9e44", "#f2c500", "#e0312b", "#f2c500", "#f2c500"]; // by MotionState
const DRAWN_FROM_BACK = [0, 1, 3, 4, 2];
const LEVEL_COLOURS = { unknown: "#8d99a3", low: "#f2c500", high: "#ff5a52" };
const PERIOD_MS = 1000;

const canvas = document.querySelector("canvas");
const pen = canvas.getContext("2d");
const byId = (id) => document.getElementById(id);

let points = new Float32Array(0); // x y state
let way = new Float32Array(0); // x y
let pose = null;
let health = null;
let density = null;
let objects = []; // those of the newest frame have a size
let asked = null; // a place that was clicked, null: the robot
let view = { x: 0, y: 0, scale: 8, fitted: true };

function toScreen(x, y) {
  return [canvas.clientWidth / 2 - (y - view.y) * view.scale, canvas.clientHeight / 2 - (x - view.x) * view.scale];
}

function toMap(left, top) {
  return [view.x - (top - canvas.clientHeight / 2) / view.scale, view.y - (left - canvas.clientWidth / 2) / view.scale];
}

// The middle 96 % of everything seen: single landmarks far away must not shrink the street to a dot.
function fit() {
  const xs = [], ys = [];
  for (let i = 0; i < points.length; i += 3) { xs.push(points[i]); ys.push(points[i + 1]); }
  const range = (values, extra) => {
    values.sort((a, b) => a - b);
    const cut = Math.floor(values.length * 0.02);
    const ends = [values[cut], values[values.length - 1 - cut], ...extra].filter(Number.isFinite);
    return ends.length ? [Math.min(...ends), Math.max(...ends)] : [-10, 10];
  };
  const every = (offset) => Array.from({ length: way.length / 2 }, (_, i) => way[2 * i + offset]);
  const [x0, x1] = range(xs, every(0)), [y0, y1] = range(ys, every(1));
  view.x = (x0 + x1) / 2;
  view.y = (y0 + y1) / 2;
  view.scale = 0.92 * Math.min(canvas.clientHeight / Math.max(x1 - x0, 1e-3), canvas.clientWidth / Math.max(y1 - y0, 1e-3));
}

function draw() {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = canvas.clientWidth * ratio;
  canvas.height = canvas.clientHeight * ratio;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (view.fitted) fit();
  drawScale();
  for (const state of DRAWN_FROM_BACK) {
    pen.fillStyle = COLOURS[state];
    const size = state === 0 ? 1.5 : 2.5;
    for (let i = 0; i < points.length; i += 3) {
      if (points[i + 2] !== state) continue;
      const [left, top] = toScreen(points[i], points[i + 1]);
      pen.fillRect(left - size / 2, top - size / 2, size, size);
    }
  }
  drawWay();
  objects.forEach(drawObject);
  drawSphere();
  drawRobot();
}

function drawWay() {
  pen.strokeStyle = "#9cc9f0";
  pen.lineWidth = 1.5;
  pen.beginPath();
  for (let i = 0; i < way.length; i += 2) pen.lineTo(...toScreen(way[i], way[i + 1]));
  pen.stroke();
}

// A box from above, and an arrow as far as the object comes in a second.
function drawObject(object) {
  if (!object.size) return;
  const [x, y] = object.position;
  const [length, width] = object.size;
  const [cos, sin] = [Math.cos(object.heading), Math.sin(object.heading)];
  pen.strokeStyle = pen.fillStyle = object.state === "moving" ? COLOURS[2] : COLOURS[1];
  pen.lineWidth = 1.5;
  pen.beginPath();
  for (const [along, across] of [[1, 1], [1, -1], [-1, -1], [-1, 1]]) {
    const [forward, left] = [along * length / 2, across * width / 2];
    pen.lineTo(...toScreen(x + cos * forward - sin * left, y + sin * forward + cos * left));
  }
  pen.closePath();
  pen.stroke();
  if (object.state === "moving") drawArrow([x, y], [x + object.velocity[0], y + object.velocity[1]]);
}

function drawArrow(from, to) {
  const [left, top] = toScreen(...to);
  const [fromLeft, fromTop] = toScreen(...from);
  pen.beginPath();
  pen.moveTo(fromLeft, fromTop);
  pen.lineTo(left, top);
  pen.stroke();
  pen.save();
  pen.translate(left, top);
  pen.rotate(Math.atan2(top - fromTop, left - fromLeft));
  pen.beginPath();
  pen.moveTo(3, 0); pen.lineTo(-5, 4); pen.lineTo(-5, -4);
  pen.fill();
  pen.restore();
}

function drawSphere() {
  if (!density || !density.position) return;
  const [left, top] = toScreen(density.position[0], density.position[1]);
  pen.strokeStyle = LEVEL_COLOURS[density.level];
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(left, top, density.radius * view.scale, 0, 2 * Math.PI);
  pen.stroke();
}

function drawRobot() {
  if (!pose || !pose.position) return;
  const [qx, qy, qz, qw] = pose.orientation;
  const [left, top] = toScreen(pose.position[0], pose.position[1]);
  pen.save();
  pen.translate(left, top);
  pen.rotate(-Math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz)));
  pen.fillStyle = "#ffffff";
  pen.beginPath();
  pen.moveTo(0, -11); pen.lineTo(7, 8); pen.lineTo(0, 4); pen.lineTo(-7, 8);
  pen.fill();
  pen.restore();
}

function drawScale() {
  const step = 10 ** Math.floor(Math.log10(160 / view.scale));
  const length = [5, 2, 1].map((n) => n * step).find((n) => n * view.scale <= 160) || step;
  const bottom = canvas.clientHeight - 18;
  pen.strokeStyle = pen.fillStyle = "#8d99a3";
  pen.lineWidth = 1.5;
  pen.strokeRect(18, bottom - 5, length * view.scale, 0);
  pen.font = "12px system-ui, sans-serif";
  pen.fillText(`${length} ${unit()}`, 18, bottom - 11);
}

const unit = () => pose && pose.scale === "metric" ? "m" : "map units";
const number = (value, digits = 1) => value.toFixed(digits);

function rows(list, pairs) {
  list.replaceChildren(...pairs.flatMap(([term, value]) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = term;
    dd.textContent = value;
    return [dt, dd];
  }));
}

function tell() {
  byId("moment").textContent = density.sequence < 0 ? "waiting for the first frame"
    : `frame ${density.sequence} · ${density.tracking} · scale ${density.scale}`;
  byId("level").textContent = density.level;
  byId("level").className = density.level;
  byId("where").textContent = density.position ? `${asked ? "at" : "around the robot,"} ${density.position.map((n) => number(n)).join(", ")}` : density.reason;
  rows(byId("density"), [
    ["moving points", density.moving_points], ["moving objects", density.moving_objects],
    ["landmarks here", density.observed_points], ["radius", `${number(density.radius)} ${density.radius_unit}`],
    ["window", density.window === "all" ? "all" : `${density.window} s`],
  ]);
  rows(byId("pose"), pose.position
    ? [[`x, y, z in ${unit()}`, pose.position.map((n) => number(n, 2)).join(", ")], ["tracking", pose.tracking]]
    : [["tracking", pose.tracking], ["", pose.reason]]);
  const dense = health.dense_points > 0 ? `, ${health.dense_points} semi-dense points` : "";
  byId("counts").textContent = `${health.landmarks} landmarks${dense}; drawn: ${points.length / 3}, ${way.length / 2} poses`;
}

function densityUrl() {
  const query = new URLSearchParams({ pose: asked ? asked.map((n) => n.toFixed(3)).join(",") : "current" });
  for (const name of ["radius", "window"]) if (byId(name).value.trim()) query.set(name, byId(name).value.trim());
  return `/density?${query}`;
}

async function ask(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error((await response.json()).detail);
  return response;
}

async function refresh() {
  try {
    [density, pose, health] = await Promise.all([ask(densityUrl()), ask("/pose"), ask("/healthz")].map(async (answer) => (await answer).json()));
    objects = (await (await ask("/objects")).json()).objects;
    const seen = await (await ask("/map/top_view")).arrayBuffer();
    const [pointCount, poseCount] = new Uint32Array(seen, 0, 2);
    points = new Float32Array(seen, 8, 3 * pointCount);
    way = new Float32Array(seen, 8 + 12 * pointCount, 2 * poseCount);
    byId("trouble").textContent = "";
    tell();
  } catch (error) {
    byId("trouble").textContent = error.message;
  }
  draw();
}

async function keepRefreshing() {
  await refresh();
  setTimeout(keepRefreshing, PERIOD_MS);
}

let held = null;
canvas.addEventListener("pointerdown", (event) => { held = { x: event.offsetX, y: event.offsetY, moved: false }; });
canvas.addEventListener("pointermove", (event) => {
  if (!held) return;
  const [dx, dy] = [event.offsetX - held.x, event.offsetY - held.y];
  if (!held.moved && Math.hypot(dx, dy) < 4) return;
  view = { x: view.x + dy / view.scale, y: view.y + dx / view.scale, scale: view.scale, fitted: false };
  held = { x: event.offsetX, y: event.offsetY, moved: true };
  draw();
});
window.addEventListener("pointerup", (event) => {
  if (held && !held.moved && event.target === canvas) {
    asked = [...toMap(event.offsetX, event.offsetY), pose && pose.position ? pose.position[2] : 0];
    refresh();
  }
  held = null;
});
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  const [x, y] = toMap(event.offsetX, event.offsetY);
  view.scale *= Math.exp(-event.deltaY / 500);
  const [x2, y2] = toMap(event.offsetX, event.offsetY);
  view = { x: view.x + x - x2, y: view.y + y - y2, scale: view.scale, fitted: false };
  draw();
}, { passive: false });
byId("follow").addEventListener("click", (event) => { event.preventDefault(); asked = null; refresh(); });
byId("fit").addEventListener("click", (event) => { event.preventDefault(); view.fitted = true; draw(); });
window.addEventListener("resize", draw);
keepRefreshing();
