// Values under the pointer. The page is complete without it.
"use strict";
for (const plot of document.querySelectorAll("svg.plot")) {
  const axes = [plot.dataset.x, plot.dataset.y].map((text) => {
    const [low, high, from, to, name, unit] = text.split("|");
    return { low: +low, high: +high, from: +from, to: +to, name, unit };
  });
  const box = plot.viewBox.baseVal;
  const note = document.createElementNS(plot.namespaceURI, "text");
  note.setAttribute("class", "note end");
  note.setAttribute("x", box.width - 14);
  note.setAttribute("y", 16);
  note.setAttribute("aria-hidden", "true");
  plot.append(note);
  const show = (axis, place) => {
    const share = (place - axis.from) / (axis.to - axis.from);
    const value = axis.low + share * (axis.high - axis.low);
    const step = Math.abs((axis.high - axis.low) / (axis.to - axis.from));
    const decimals = Math.min(9, Math.max(0, Math.ceil(-Math.log10(step))));
    const inside = share >= 0 ? 1 >= share : false;
    return inside ? `${axis.name} = ${value.toFixed(decimals)} ${axis.unit}`.trim() : "";
  };
  plot.addEventListener("pointermove", (event) => {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(plot.getScreenCTM().inverse());
    const parts = [show(axes[0], point.x), show(axes[1], point.y)];
    note.textContent = parts.every(Boolean) ? parts.join(", ") : "";
  });
  plot.addEventListener("pointerleave", () => { note.textContent = ""; });
}
