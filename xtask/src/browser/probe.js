// What a person would do with a report: look at it, point at a figure, click every event.
"use strict";
const seen = { window: 0, errors: [], rows: 0, opened: 0, wrong: [], torn: [], hover: null };
addEventListener("error", (event) => seen.errors.push(event.message));
addEventListener("load", () => {
  seen.window = innerWidth;
  tear();
  seen.hover = point();
  const noise = JSON.parse(document.getElementById("data")?.textContent ?? "{}").noise;
  for (const row of document.querySelectorAll("tr[data-event]")) {
    seen.rows += 1;
    row.click();
    const wrong = closer(row.dataset.event, row.classList.contains("bad"), noise);
    if (wrong) seen.wrong.push(`event ${row.dataset.event}: ${wrong}`); else seen.opened += 1;
  }
  tear();
  parent.postMessage(JSON.stringify(seen), "*");
});

// Whatever is wider than the window, but for what has a scroll bar of its own.
function tear() {
  for (const element of document.body.querySelectorAll("*")) {
    const box = element.getBoundingClientRect();
    const over = box.width > 0 && (box.right > innerWidth + 1 || 0 > box.left + 1);
    if (over && !element.closest(".scroll") && !element.closest("g[clip-path]")) {
      seen.torn.push(`${element.tagName} ${element.getAttribute("class")} to ${box.right.toFixed(0)}`);
    }
  }
}

// The note of the first figure with a pointer near the middle.
function point() {
  const plot = [...document.querySelectorAll("svg.plot")].find((p) => p.getBoundingClientRect().width > 0);
  for (const part of [0.3, 0.4, 0.5, 0.6, 0.7]) {
    const note = under(plot, 0.5, part);
    if (note.startsWith("sample")) return note;
  }
  return null;
}

function under(plot, x, y) {
  const box = plot.getBoundingClientRect();
  const place = { clientX: box.left + x * box.width, clientY: box.top + y * box.height };
  plot.dispatchEvent(new PointerEvent("pointermove", place));
  return plot.querySelector("text.note").textContent;
}

// What is wrong with the look at an event that is open now.
function closer(event, bad, noise) {
  const panel = document.querySelector(".look");
  if (document.querySelectorAll(".look").length !== 1) return "not one panel";
  const title = panel.querySelector("b").textContent;
  if (!title.startsWith(`Event ${event}:`)) return title;
  const plots = [...panel.querySelectorAll("svg.closer")];
  if (plots.length !== 2) return `${plots.length} figures`;
  const dots = plots.map((plot) => plot.querySelector("path.sample, path.sample-line")?.getAttribute("d") ?? "");
  // The samples of a day do not fit into a page: then that is said.
  if (title.includes("not kept")) return dots.some((d) => d !== "") ? "samples after all" : "";
  if (dots.some((d) => d === "")) return "no samples or no residuals";
  if (!plots[0].querySelector("path.model")?.getAttribute("d")) return "no fit";
  if (bad) return "";
  // Residuals of a wrong curve would be hundreds of N; flop after the stop is tens.
  const marks = [...plots[1].querySelectorAll("text.end")].map((text) => text.textContent.replace("\u2212", "-"));
  const widest = Math.max(...marks.map(Number).filter(Number.isFinite));
  return widest > 30 * noise ? `residuals to ${widest}, noise ${noise}` : "";
}
