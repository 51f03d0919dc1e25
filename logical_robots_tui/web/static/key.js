"use strict";
// The key of the games, which leaves the address bar at once, and what a page's game is found by.

const key = location.hash.slice(1) || sessionStorage.getItem("key") || "";
const tab = sessionStorage.getItem("tab") || crypto.getRandomValues(new Uint32Array(4)).join("-");
sessionStorage.setItem("key", key);
sessionStorage.setItem("tab", tab);
history.replaceState(null, "", location.pathname + location.search);

const protocols = ["logical-robots", key || "none", tab];
