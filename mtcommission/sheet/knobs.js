// Sliders with an entry beside each: what is moved goes into `state`; a wrong entry is said.

function makeKnobs({fields, state, id, outOfRange}) {
  const field = Object.fromEntries(fields.map(item => [item.key, item]));
  const onSlider = (item, value) => item.log ? 1000 * Math.log(value / item.low) / Math.log(item.high / item.low) : 1000 * (value - item.low) / (item.high - item.low);
  const ofSlider = (item, place) => item.log ? item.low * (item.high / item.low) ** (place / 1000) : item.low + (item.high - item.low) * place / 1000;

  function put(key, value, {slider = true, text = true} = {}) {
    const item = field[key];
    // What is shown is what is computed: four digits, unless more are typed.
    if (text) value = Number((value / item.size).toPrecision(4)) * item.size;
    state[key] = value;
    if (slider) id(`${key}-slider`).value = onSlider(item, value);
    id(`${key}-slider`).setAttribute("aria-valuetext", `${show(value / item.size)} ${item.unit}`);
    if (text) id(key).value = String(Number((value / item.size).toPrecision(10))).replace(".", data.decimal_mark);
    id(key).removeAttribute("aria-invalid");
    complain();
  }

  // Every wrong entry, as long as it stands there; what is computed is the value before it.
  function complain() {
    const wrong = fields.filter(item => id(item.key).getAttribute("aria-invalid") === "true");
    const range = item => outOfRange({name: item.label, low: `${show(item.least / item.size)} ${item.unit}`, high: `${show(item.most / item.size)} ${item.unit}`, value: `${show(state[item.key] / item.size)} ${item.unit}`});
    id("complaint").textContent = wrong.map(range).join(". ");
  }

  function listenTo(item, after) {
    id(`${item.key}-slider`).addEventListener("input", event => { put(item.key, ofSlider(item, Number(event.target.value)), {slider: false}); after(); });
    id(item.key).addEventListener("input", event => {
      const value = Number(event.target.value.trim().replace(",", ".").replace("−", "-")) * item.size;
      const isGood = event.target.value.trim() !== "" && Number.isFinite(value) && value >= item.least && value <= item.most;
      event.target.setAttribute("aria-invalid", String(!isGood));
      complain();
      if (isGood) { put(item.key, value, {text: false}); after(); }
    });
  }

  return {field, put, listenTo};
}
