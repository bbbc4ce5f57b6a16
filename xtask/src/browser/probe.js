// What a person would do with a report: look at it, point at a figure, click every event.
"use strict";
const seen = {
  window: 0, dark: false, errors: [], rows: 0, opened: 0, wrong: [], torn: [], faint: [], figures: 0, mute: [], highest: null,
};
addEventListener("error", (event) => seen.errors.push(event.message));
addEventListener("load", () => {
  seen.window = innerWidth;
  seen.dark = matchMedia("(prefers-color-scheme: dark)").matches;
  tear();
  fade();
  for (const plot of document.querySelectorAll("svg.plot")) {
    if (plot.getBoundingClientRect().width === 0) continue;
    seen.figures += 1;
    if (!tells(plot)) seen.mute.push(plot.id);
  }
  const figures = [...document.querySelectorAll("figure")];
  if (figures.every((figure) => getComputedStyle(figure).breakInside === "avoid")) {
    seen.highest = Math.max(...figures.map((figure) => figure.getBoundingClientRect().height));
  }
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

// Text with less contrast than people can read: 4.5, as WCAG 2 has it.
function fade() {
  for (const element of document.body.querySelectorAll("*")) {
    const own = [...element.childNodes].filter((node) => node.nodeType === Node.TEXT_NODE);
    const text = own.map((node) => node.data).join("").trim();
    if (!text || ["SCRIPT", "title", "desc"].includes(element.tagName)) continue;
    const style = getComputedStyle(element);
    const found = contrast(element.closest("svg") ? style.fill : style.color, behind(element));
    if (!(found >= 4.5)) seen.faint.push(`${element.tagName} ${text.slice(0, 30)}: ${found.toFixed(1)}`);
  }
}

// The nearest background that nothing shines through.
function behind(element) {
  for (let at = element; at; at = at.parentElement) {
    const colour = getComputedStyle(at).backgroundColor;
    if (colour.startsWith("rgb(")) return colour;
  }
  return "rgb(255, 255, 255)";
}

function contrast(...colours) {
  const lights = colours.map((colour) => {
    const [r, g, b] = colour.match(/[\d.]+/g).map((part) => part / 255)
      .map((part) => (part > 0.04045 ? ((part + 0.055) / 1.055) ** 2.4 : part / 12.92));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  });
  return (Math.max(...lights) + 0.05) / (Math.min(...lights) + 0.05);
}

// Whether a pointer finds a data point somewhere in a figure.
function tells(plot) {
  for (let x = 0.01; 1 > x; x += 0.01) {
    for (let y = 0.05; 1 > y; y += 0.05) {
      if (/^(sample|event) \d/.test(under(plot, x, y))) return true;
    }
  }
  return false;
}

function under(plot, x, y) {
  const box = plot.getBoundingClientRect();
  const place = { clientX: box.left + x * box.width, clientY: box.top + y * box.height };
  plot.dispatchEvent(new PointerEvent("pointermove", place));
  return plot.querySelector("text.note[aria-hidden]").textContent;
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
