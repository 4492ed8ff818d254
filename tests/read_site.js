// What the script of the pages reads numbers with, for checks that run without a page: whatever it asks of one is swallowed.
"use strict";
const path = require("path");
const nothing = new Proxy(function () {}, {
  get: (_, key) => (key === Symbol.iterator ? () => [][Symbol.iterator]() : key === Symbol.toPrimitive ? () => "" : nothing),
  apply: () => nothing,
  set: () => true,
});
Object.assign(globalThis, { document: nothing, location: nothing, history: nothing, addEventListener: () => {} });
module.exports = require(path.join(__dirname, "..", "templates", "site.js"));
