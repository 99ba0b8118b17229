"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);
  const MARKS = 11;
  const TURN_SECONDS = 8;
  const TEN_MS = 900;
  const PREFIX = "mve-ratings " + data.page + " ";

  // What was marked is kept by the browser, where it lets a page keep something.
  let keeps = true;
  function keep(state) {
    try {
      localStorage.setItem(PREFIX + state.rater, JSON.stringify(state));
    } catch (error) {
      keeps = false;
    }
  }
  function kept() {
    const all = [];
    try {
      for (let i = 0; i < localStorage.length; i++) {
        const key = localStorage.key(i);
        if (!key.startsWith(PREFIX)) continue;
        try {
          const state = JSON.parse(localStorage.getItem(key));
          if (state && typeof state.rater === "string" && typeof state.marks === "object") {
            all.push(state);
          }
        } catch (error) { /* Somebody else wrote it. */ }
      }
    } catch (error) {
      keeps = false;
    }
    return all.sort((a, b) => (a.rater < b.rater ? -1 : 1));
  }

  // The order is drawn by the name of the rater, so that it is the same after a reload.
  // FNV-1a (Fowler, Noll, Vo 1991), then mulberry32 (T. Ettinger 2017).
  function seedOf(text) {
    let hash = 0x811c9dc5;
    for (const byte of new TextEncoder().encode(text)) {
      hash = Math.imul(hash ^ byte, 0x01000193) >>> 0;
    }
    return hash;
  }
  function drawn(seed) {
    let state = seed;
    return function () {
      state = (state + 0x6d2b79f5) >>> 0;
      let t = Math.imul(state ^ (state >>> 15), state | 1);
      t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
      return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
    };
  }
  function orderOf(rater) {
    const random = drawn(seedOf(data.page + "\n" + rater));
    const order = data.items.map((_, place) => place);
    for (let i = order.length - 1; i > 0; i--) {
      const j = Math.floor(random() * (i + 1));
      [order[i], order[j]] = [order[j], order[i]];
    }
    return order;
  }

  // Pictures: one sheet a mesh, a picture for each angle.
  const sheets = new Map();
  function sheet(list, place) {
    const key = list + " " + place;
    if (!sheets.has(key)) {
      const image = new Image();
      image.onload = draw;
      image.src = "data:image/png;base64," + data[list][place];
      sheets.set(key, image);
      // Those of a few pairs are enough to go back and forth.
      if (sheets.size > 12) sheets.delete(sheets.keys().next().value);
    }
    return sheets.get(key);
  }

  let state = null;
  let order = [];
  let at = 0;
  let angle = 0;
  let turns = true;
  let shownSince = 0;
  let typedOne = 0;

  const panes = [byId("original"), byId("result")];
  panes.forEach((pane) => { pane.width = data.size; pane.height = data.size; });

  function draw() {
    if (!state || byId("rate").hidden) return;
    const item = data.items[order[at]];
    const both = [sheet("originals", item.original), sheet("results", order[at])];
    const frame = ((Math.round(angle) % data.frames) + data.frames) % data.frames;
    panes.forEach((pane, side) => {
      const context = pane.getContext("2d");
      const image = both[side];
      if (!image.complete || !image.naturalWidth) {
        context.clearRect(0, 0, data.size, data.size);
        return;
      }
      const x = (frame % data.columns) * data.size;
      const y = Math.floor(frame / data.columns) * data.size;
      context.drawImage(image, x, y, data.size, data.size, 0, 0, data.size, data.size);
    });
    byId("angle").value = String(frame);
  }

  let last = performance.now();
  function tick(now) {
    const seconds = Math.min((now - last) / 1000, 0.2);
    last = now;
    if (turns && state && !byId("rate").hidden) {
      const before = Math.round(angle);
      angle += (seconds * data.frames) / TURN_SECONDS;
      if (Math.round(angle) !== before) draw();
    }
    requestAnimationFrame(tick);
  }
  function setTurning(on) {
    turns = on;
    byId("play").textContent = on ? "Stop turning" : "Turn";
  }

  // Marks.
  const buttons = [];
  for (let mark = 0; mark < MARKS; mark++) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = String(mark);
    button.setAttribute("aria-label", "mark " + mark);
    button.addEventListener("click", () => setMark(mark));
    byId("marks").append(button);
    buttons.push(button);
  }
  const stepAt = () => data.items[order[at]].step;
  const markAt = () => (state.marks[stepAt()] ? state.marks[stepAt()].mark : null);
  const countOf = (other) => data.items.filter((item) => other.marks[item.step]).length;

  function setMark(mark) {
    const known = state.marks[stepAt()];
    const seconds = (known ? known.seconds : 0) + (performance.now() - shownSince) / 1000;
    shownSince = performance.now();
    state.marks[stepAt()] = { mark: mark, position: at + 1, seconds: Math.round(seconds * 10) / 10 };
    keep(state);
    showMarks();
  }
  function showMarks() {
    const mark = markAt();
    buttons.forEach((button, place) => {
      button.setAttribute("aria-pressed", String(place === mark));
    });
    const n = countOf(state);
    byId("count").textContent = "pair " + (at + 1) + " of " + order.length;
    byId("progress").value = n;
    byId("back").disabled = at === 0;
    byId("next").disabled = mark === null;
    byId("next").textContent = at + 1 === order.length ? "Finish" : "Next";
    byId("kept").textContent = keeps
      ? n + " marked; your marks are kept in this browser."
      : n + " marked. This browser keeps nothing: do not close the page before you have the file.";
  }
  function show(place) {
    at = Math.max(0, Math.min(place, order.length - 1));
    state.at = at;
    keep(state);
    shownSince = performance.now();
    panel("rate");
    showMarks();
    draw();
    // The next pair is decoded while this one is looked at.
    if (at + 1 < order.length) sheet("results", order[at + 1]);
  }
  function next() {
    if (markAt() === null) return;
    if (at + 1 < order.length) { show(at + 1); return; }
    const open = order.findIndex((place) => !state.marks[data.items[place].step]);
    if (open >= 0) show(open); else finish();
  }

  function panel(name) {
    for (const id of ["start", "rate", "end"]) byId(id).hidden = id !== name;
  }
  function finish() {
    panel("end");
    byId("thanks").textContent = countOf(state) + " of " + order.length + " pairs are marked.";
    byId("text").value = file();
  }
  function file() {
    const marks = order
      .map((place) => data.items[place].step)
      .filter((step) => state.marks[step])
      .map((step) => Object.assign({ step: step }, state.marks[step]));
    return JSON.stringify({
      mve_ratings: 1, program: data.program, page: data.page, rater: state.rater,
      saved: new Date().toISOString(), marks: marks,
    }, null, 1) + "\n";
  }
  function download() {
    const name = state.rater.replace(/[^\p{L}\p{N}_-]+/gu, "-") || "ratings";
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([file()], { type: "application/json" }));
    link.download = "ratings-" + name + ".json";
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  function begin(rater) {
    state = kept().find((known) => known.rater === rater) || { rater: rater, marks: {}, at: 0 };
    order = orderOf(rater);
    keep(state);
    show(Number.isInteger(state.at) ? state.at : 0);
  }
  function start() {
    panel("start");
    const list = byId("known");
    list.replaceChildren();
    for (const known of kept()) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent =
        "Go on as " + known.rater + " (" + countOf(known) + " of " + data.items.length + ")";
      button.addEventListener("click", () => begin(known.rater));
      list.append(button);
    }
    byId("name").focus();
  }

  byId("form").addEventListener("submit", (event) => {
    event.preventDefault();
    const name = byId("name").value.trim().slice(0, 60);
    if (name) begin(name);
  });
  byId("back").addEventListener("click", () => show(at - 1));
  byId("next").addEventListener("click", next);
  byId("review").addEventListener("click", () => show(0));
  byId("other").addEventListener("click", start);
  byId("play").addEventListener("click", () => setTurning(!turns));
  byId("angle").addEventListener("input", () => {
    setTurning(false);
    angle = Number(byId("angle").value);
    draw();
  });
  for (const id of ["save", "save-now"]) byId(id).addEventListener("click", download);

  for (const pane of panes) {
    let from = null;
    pane.addEventListener("pointerdown", (event) => {
      from = { x: event.clientX, angle: angle };
      setTurning(false);
      pane.setPointerCapture(event.pointerId);
    });
    pane.addEventListener("pointermove", (event) => {
      if (from === null) return;
      // Across a picture it turns by half.
      const share = (event.clientX - from.x) / Math.max(pane.clientWidth, 1);
      angle = from.angle - (share * data.frames) / 2;
      draw();
    });
    for (const end of ["pointerup", "pointercancel"]) {
      pane.addEventListener(end, () => { from = null; });
    }
  }

  document.addEventListener("keydown", (event) => {
    if (byId("rate").hidden || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key;
    const now = performance.now();
    if (/^[0-9]$/.test(key)) {
      const isTen = key === "0" && now - typedOne < TEN_MS && markAt() === 1;
      setMark(isTen ? 10 : Number(key));
      typedOne = key === "1" ? now : 0;
    } else if (key === "ArrowUp" || key === "+") {
      setMark(Math.min((markAt() === null ? -1 : markAt()) + 1, MARKS - 1));
    } else if (key === "ArrowDown" || key === "-") {
      setMark(Math.max((markAt() === null ? MARKS : markAt()) - 1, 0));
    } else if (key === "Enter" || key === "PageDown") {
      next();
    } else if (key === "Backspace" || key === "PageUp") {
      if (at > 0) show(at - 1);
    } else if (key === "ArrowLeft" || key === "ArrowRight") {
      setTurning(false);
      angle += key === "ArrowLeft" ? 1 : -1;
      draw();
    } else if (key === " ") {
      setTurning(!turns);
    } else {
      return;
    }
    event.preventDefault();
  });

  byId("progress").max = data.items.length;
  byId("angle").max = String(data.frames - 1);
  setTurning(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  start();
  requestAnimationFrame(tick);
})();
