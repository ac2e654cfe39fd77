// Handles pointer, wheel and keys on the viewer's stage.
const grab = 14; // the divider can be grabbed within this many pixels

/** Makes a stage react to input; `actions` has flip(), setSplit(share) and exposeBy(stops). */
function listenToGestures(stage, state, actions) {
  const {place} = stage;
  const pointers = new Map();
  let onDivider = false;
  const point = (event) => {
    const box = place.getBoundingClientRect();
    return {x: event.clientX - box.left - place.clientLeft, y: event.clientY - box.top - place.clientTop};
  };
  const inCell = ({x, y}) => ({x: x % stage.cell.width, y: y % stage.cell.height});
  const pixelAt = (place) => { const {x, y} = inCell(place); return stage.pixelAt(x, y); };
  const nearDivider = ({x}) => state.mode === 1 && Math.abs(x - stage.splitX) < grab;

  place.addEventListener("pointerdown", (event) => {
    const here = point(event);
    pointers.set(event.pointerId, here);
    onDivider = pointers.size === 1 && nearDivider(here);
    place.setPointerCapture(event.pointerId);
  });
  place.addEventListener("pointermove", (event) => {
    const here = point(event);
    const before = pointers.get(event.pointerId);
    place.classList.toggle("on-divider", onDivider || nearDivider(here));
    if (!before) {
      stage.setCursor(pixelAt(here));
      return;
    }
    if (pointers.size === 1) {
      if (onDivider) actions.setSplit(here.x / place.clientWidth);
      else stage.pan(here.x - before.x, here.y - before.y);
    } else if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
      const length = (p) => Math.hypot(p.x - other.x, p.y - other.y);
      const {x, y} = inCell({x: (here.x + other.x) / 2, y: (here.y + other.y) / 2});
      if (length(before) > 0) stage.setZoom(stage.zoom * length(here) / length(before), x, y);
    }
    pointers.set(event.pointerId, here);
  });
  for (const name of ["pointerup", "pointercancel"])
    place.addEventListener(name, (event) => {
      const here = point(event);
      if (name === "pointerup" && event.pointerType !== "mouse") stage.setCursor(pixelAt(here));
      pointers.delete(event.pointerId);
      onDivider = false;
    });
  // If the stage does not have the focus, the wheel scrolls the page.
  place.addEventListener("wheel", (event) => {
    if (document.activeElement !== place && !event.ctrlKey) return;
    event.preventDefault();
    const {x, y} = inCell(point(event));
    stage.setZoom(stage.zoom * 1.2 ** (event.deltaY < 0 ? 1 : -1), x, y);
  }, {passive: false});
  place.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const far = event.shiftKey ? 10 : 1;
    const keys = {
      " ": () => actions.flip(),
      ArrowLeft: () => stage.moveCursor(-far, 0),
      ArrowRight: () => stage.moveCursor(far, 0),
      ArrowUp: () => stage.moveCursor(0, -far),
      ArrowDown: () => stage.moveCursor(0, far),
      "+": () => stage.zoomBy(1.5),
      "=": () => stage.zoomBy(1.5),
      "-": () => stage.zoomBy(1 / 1.5),
      0: () => stage.fit(),
      1: () => { stage.setZoom(1, 0, 0); stage.center(); },
      "[": () => actions.setSplit(state.split - 0.05),
      "]": () => actions.setSplit(state.split + 0.05),
      ",": () => actions.exposeBy(-0.5),
      ".": () => actions.exposeBy(0.5),
    };
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
