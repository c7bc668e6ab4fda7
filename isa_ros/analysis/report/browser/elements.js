'use strict';
// What every script of a page needs: a colour of its style, an element, a number as text.

const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const element = (parent, tag, className, text) => {
  const made = parent.appendChild(document.createElement(tag));
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
};
const shown = v => v === undefined || !Number.isFinite(v) ? '–'
  : v !== 0 && (Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3) ? v.toExponential(3) : v.toPrecision(5);
