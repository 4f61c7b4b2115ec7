"use strict";
// Elements and the tooltip.

// Makes an element with attributes and children. Children that are no elements become text.
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

const byId = (id) => document.getElementById(id);

// Options are texts, or pairs of a value and a text.
function fillSelect(select, options, chosen) {
  const pairs = options.map((option) => Array.isArray(option) ? option : [option, option]);
  select.replaceChildren(...pairs.map(([value, text]) => make("option", { value }, text)));
  if (pairs.some(([value]) => value === chosen)) select.value = chosen;
}

// Removes a section and its link.
function dropSection(id) {
  byId(id).remove();
  document.querySelector(`nav a[href="#${id}"]`)?.remove();
}

// Shows an element's data-tip while the pointer is over it or it has the focus.
function startTips() {
  const tip = byId("tip");
  const show = (target) => {
    tip.hidden = !target;
    if (!target) return;
    tip.textContent = target.dataset.tip;
    const at = target.getBoundingClientRect(), own = tip.getBoundingClientRect();
    const above = at.top - own.height - 6;
    const left = Math.min(at.left + at.width / 2 - own.width / 2, document.documentElement.clientWidth - own.width - 4);
    tip.style.left = `${Math.max(4, left) + window.scrollX}px`;
    tip.style.top = `${(above > 4 ? above : at.bottom + 6) + window.scrollY}px`;
  };
  for (const event of ["pointerover", "focusin"]) {
    document.addEventListener(event, ({ target }) => show(target.closest?.("[data-tip]")));
  }
  document.addEventListener("focusout", () => show(null));
  document.addEventListener("keydown", ({ key }) => key === "Escape" && show(null));
}
