// SPDX-License-Identifier: Apache-2.0
// The page: puts the parts together, draws when something changed, and measures its picture against that of the CPU.
"use strict";

function showError(error) {
  const place = document.getElementById("error");
  place.textContent = String(error.message ?? error);
  place.hidden = false;
}

/// The largest size that the canvas has room for, in the shape of the scene.
function canvasSize(canvas, [width, height]) {
  const scale = Math.min(devicePixelRatio || 1, 4096 / Math.max(width, height) * width / Math.max(1, canvas.clientWidth));
  const across = Math.max(1, Math.round(canvas.clientWidth * scale));
  return [across, Math.max(1, Math.round((across * height) / width))];
}

/// How the page's picture at the scene's own camera and values differs from that of isoshade's cpu backend, number by
/// number. `encoded`: by more than one of 255 steps in a channel, as an image file holds it.
function compare(mine, reference, { encoding, exposure }) {
  const bits = new Uint32Array(mine.buffer), wanted = new Uint32Array(reference.buffer);
  const byte = (rgba, at, channel) => {
    const alpha = rgba[at + 3];
    const divisor = alpha > 0 && alpha < 1 ? alpha : 1;
    const value = channel === 3 ? alpha : (rgba[at + channel] * exposure) / divisor;
    const clamped = value > 0 ? Math.min(value, 1) : 0;
    return Math.floor(255 * (channel < 3 && encoding === "srgb" ? srgbEncode(clamped) : clamped) + 0.5);
  };
  const result = { pixels: mine.length / 4, bits: 0, encoded: 0, largest: 0 };
  for (let at = 0; at < mine.length; at += 4) {
    let same = true, largest = 0;
    for (let channel = 0; channel < 4; ++channel) {
      same &&= bits[at + channel] === wanted[at + channel];
      largest = Math.max(largest, Math.abs(byte(mine, at, channel) - byte(reference, at, channel)));
    }
    result.bits += same ? 0 : 1;
    result.encoded += largest > 1 ? 1 : 0;
    result.largest = Math.max(result.largest, largest);
  }
  return result;
}

function comparisonText({ pixels, bits, encoded, largest }, { width, height }) {
  const count = (number) => number.toLocaleString("en");
  return `Of ${count(pixels)} pixels (${width} x ${height}, the scene's own camera and values), ${count(bits)} differ in a bit from ` +
    `isoshade's CPU picture and ${count(encoded)} by more than 1/255; the largest difference is ${largest}/255.`;
}

/// Draws the scene as it is, at the size of the picture of the CPU.
function measure(frame, data) {
  const place = document.getElementById("measured");
  if (!frame.hasFloats) {
    place.textContent = "This browser cannot draw into images of floats: the picture is not compared with isoshade's.";
    return;
  }
  const { width, height, view, rgba } = data.reference;
  const image = frame.draw(unpack(view, 0, data.layouts.view), data.time, width, height);
  const result = compare(image.read(), rgba, data);
  place.textContent = comparisonText(result, data.reference);
  Object.assign(place.dataset, result);
}

function start() {
  const data = readData();
  const canvas = document.getElementById("picture");
  const gl = canvas.getContext("webgl2", { alpha: false, antialias: false, depth: false });
  document.title = `${data.name} \u2013 isoshade`;
  document.getElementById("name").textContent = data.name;
  document.getElementById("doc").textContent = data.doc;
  canvas.style.aspectRatio = `${data.size[0]} / ${data.size[1]}`;
  const warn = (text) => document.getElementById("warnings").append(element("li", {}, text));
  data.warnings.forEach(warn);
  if (!gl) throw new Error("this page needs WebGL2, which this browser does not have or has switched off");

  const values = new Values(data.owners);
  const frame = new Frame(gl, data, values);
  const encode = makeEncoder(gl);
  measure(frame, data);

  let waiting = false;
  const redraw = () => {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  };
  const panel = document.getElementById("panel");
  const clock = makeClock(panel, data.time, data.reads_time, redraw);
  const orbit = new Orbit(canvas, data.camera, redraw);
  const settings = document.getElementById("settings");
  const showSettings = () => {
    const texts = [...values.settings(), ...orbit.settings()].map((text) => `--set ${text}`);
    settings.value = [...texts, ...clock.settings()].join(" \\\n");
  };
  const draw = () => {
    waiting = false;
    try {
      const [width, height] = canvasSize(canvas, data.size);
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      encode(frame.draw(viewOf(orbit.camera, width, height), clock.now(), width, height), data);
      showSettings();
      canvas.dataset.frames = Number(canvas.dataset.frames ?? 0) + 1;
    } catch (error) { showError(error); }
    if (clock.runs()) redraw();
  };
  makePanel(panel, values);
  values.listeners.push(redraw);
  new ResizeObserver(redraw).observe(canvas);
  document.getElementById("copy").addEventListener("click", async () => {
    settings.select();
    try { await navigator.clipboard.writeText(settings.value); } catch { document.execCommand("copy"); }
  });
  document.getElementById("reset").addEventListener("click", () => {
    values.resetAll();
    clock.reset();
    orbit.reset();
  });
  redraw();
}

try { start(); } catch (error) { showError(error); }
