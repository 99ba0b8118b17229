"use strict";
// Sorting by a click on a heading: numbers by value, texts by letters, empty cells last.
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, place) => {
    head.tabIndex = 0;
    const sort = () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      heads.forEach(other => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      const body = table.tBodies[0];
      const key = row => {
        const cell = row.cells[place];
        return cell.dataset.v === undefined ? cell.textContent : Number(cell.dataset.v);
      };
      const rows = [...body.rows].map(row => [key(row), row]);
      rows.sort(([a], [b]) => {
        if (a === "" || b === "") return (a === "") - (b === "");
        const both = typeof a === "number" && typeof b === "number";
        const order = both ? a - b : String(a).localeCompare(String(b), undefined, { numeric: true });
        return up ? order : -order;
      });
      body.append(...rows.map(([, row]) => row));
    };
    head.addEventListener("click", sort);
    head.addEventListener("keydown", event => { if (event.key === "Enter") sort(); });
  });
}
// A click on a picture shows it large; the arrow keys go to the next.
const pictures = [...document.querySelectorAll("figure img")];
const dialog = document.querySelector("dialog");
if (dialog && pictures.length > 0) {
  const [large, text] = [dialog.querySelector("img"), dialog.querySelector("p")];
  let shown = 0;
  const show = place => {
    shown = (place + pictures.length) % pictures.length;
    large.src = pictures[shown].src;
    text.textContent = pictures[shown].alt;
  };
  pictures.forEach((picture, place) => picture.addEventListener("click", () => {
    show(place);
    dialog.showModal();
  }));
  dialog.addEventListener("click", () => dialog.close());
  dialog.addEventListener("keydown", event => {
    if (event.key === "ArrowRight") show(shown + 1);
    if (event.key === "ArrowLeft") show(shown - 1);
  });
}
// First columns stay where a table scrolls, as long as they leave half of the room, and a line says
// that it does.
for (const box of document.querySelectorAll(".scroll")) {
  const settle = () => {
    const scrolls = box.scrollWidth > box.clientWidth + 1;
    const hint = box.previousElementSibling;
    if (hint?.className === "hint") hint.hidden = !scrolls;
    else if (scrolls) {
      const line = document.createElement("p");
      line.className = "hint";
      line.textContent = "This table scrolls sideways →";
      box.before(line);
    }
    let left = 0;
    for (let place = 0; ; place++) {
      const head = box.querySelector(`thead .h${place}`);
      if (!head || left + head.offsetWidth > box.clientWidth / 2) break;
      for (const cell of box.querySelectorAll(`.h${place}`)) {
        cell.classList.toggle("stays", scrolls);
        cell.style.left = `${left}px`;
      }
      left += head.offsetWidth;
    }
  };
  settle();
  addEventListener("resize", settle);
}
