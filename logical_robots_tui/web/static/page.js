"use strict";
// What textual.js leaves to its page: fonts, focus, pasting, titles, downloads, the end.

let isPlaying = false;
let socket;
let reason = "The connection to the game is lost. Unsaved text is kept.";

const handlers = {
  title: (text) => { document.title = `${text} · Logical Robots`; },
  ended: (text) => { reason = text || "The game has ended."; },
  // textual.js would open a window, which browsers block.
  deliver_file_start: (name) => {
    const link = document.createElement("a");
    link.href = `download/${name}`;
    link.download = "";
    link.click();
  },
};

window.WebSocket = class extends WebSocket {
  constructor(address) {
    super(address, protocols);
    isPlaying = true;
    socket = this;
    this.addEventListener("message", (event) => {
      if (typeof event.data !== "string") return;
      const [kind, content] = JSON.parse(event.data);
      handlers[kind]?.(content);
      if (kind === "deliver_file_start") event.stopImmediatePropagation();
    });
    this.addEventListener("close", () => {
      isPlaying = false;
      document.querySelector("#reason").textContent = reason;
      document.querySelector("#end").hidden = false;
      document.querySelector("#end button").focus();
    });
  }

  send(message) {
    if (this.readyState === WebSocket.OPEN) super.send(message); // textual.js does not look
  }
};

const start = window.onload;
window.onload = async (event) => {
  const terminal = document.querySelector(".textual-terminal");
  terminal.dataset.sessionWebsocketUrl = new URL("ws", location.href).href.replace("http", "ws");
  terminal.dataset.fontSize = parseFloat(getComputedStyle(document.documentElement).fontSize);
  document.querySelector("#plain").onclick = () => { isPlaying = false; };
  document.querySelector("#end button").onclick = () => location.reload();
  // The terminal measures a letter once.
  const faces = ["16px", "bold 16px"].map((size) => document.fonts.load(`${size} "Roboto Mono"`));
  await Promise.allSettled([...faces, document.fonts.load('16px "Roboto Mono"', "\u2800")]);
  start(event);
  document.querySelector(".xterm-helper-textarea").focus();
};

// ^V pastes the browser's clipboard, into which the game copies.
window.addEventListener("keydown", (event) => {
  if ((event.ctrlKey || event.metaKey) && event.key === "v") event.stopImmediatePropagation();
}, true);

// ^W, which deletes a word, closes the page in browsers; they ask first.
window.addEventListener("beforeunload", (event) => {
  if (isPlaying) event.preventDefault();
});
