"use strict";
// The table of holes: column heads sort, rows lead to their blocks, arrow keys go from row to row.
function holeTable(onRow) {
  const table = document.querySelector("table.holes");
  if (!table) return { show() {} };
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  const key = (row, column) => {
    const cell = row.cells[column];
    const text = cell.dataset.value ?? cell.textContent.trim();
    return text === "" ? null : text;
  };
  const compare = (a, b) => {
    const [x, y] = [Number(a), Number(b)];
    return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b, "en", { numeric: true }) : x - y;
  };

  function sort(column) {
    const head = heads[column];
    const down = head.getAttribute("aria-sort") === "ascending";
    heads.forEach((other) => other.setAttribute("aria-sort", "none"));
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const keyed = [...body.rows].map((row) => [key(row, column), row]);
    // Rows without a value are last in either direction.
    keyed.sort(([a], [b]) => {
      if (a === null || b === null) return (a === null) - (b === null);
      return down ? compare(b, a) : compare(a, b);
    });
    body.append(...keyed.map(([, row]) => row));
  }

  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => sort(column)));
  body.addEventListener("click", (event) => {
    // A press on one row that is released on another belongs to neither.
    const row = event.target.closest("tr");
    if (!row) return;
    onRow(Number(row.dataset.row));
    if (!event.target.closest("a")) row.querySelector("a.go")?.click();
  });
  body.addEventListener("focusin", (event) => onRow(Number(event.target.closest("tr").dataset.row)));
  body.addEventListener("keydown", (event) => {
    const step = { ArrowDown: "nextElementSibling", ArrowUp: "previousElementSibling" }[event.key];
    if (!step) return;
    event.preventDefault();
    let row = event.target.closest("tr")[step];
    while (row && (row.hidden || !row.querySelector("a.go"))) row = row[step];
    row?.querySelector("a.go").focus();
  });
  document.getElementById("show-rows")?.addEventListener("click", () => {
    for (const row of body.rows) row.hidden = false;
    document.getElementById("hidden-rows").remove();
    heads[0].querySelector("button").focus();
  });

  return {
    // Marks the row of a hole.
    show(number) {
      body.querySelector("tr.picked")?.classList.remove("picked");
      document.getElementById(`hole-${number}`)?.classList.add("picked");
    },
  };
}
