"use strict";
// The game in lines: a log that screen readers follow, and a field for commands.

const MOST_LINES = 5000; // in the log
const MOST_COMMANDS = 200; // to go back to
const STOP = "\x03";

const log = document.querySelector("#log");
const form = document.querySelector("form");
const field = document.querySelector("#line");
const again = document.querySelector("#again");
const commands = [];
let place = 0; // among the commands
let rest = ""; // of a line that has begun
let reason = "The connection to the game is lost. Your text is kept.";

const address = new URL("ws?plain", location.href);
address.protocol = address.protocol.replace("http", "ws");
const socket = new WebSocket(address, protocols);
const decoder = new TextDecoder();
socket.binaryType = "arraybuffer";

function show(lines, kind = "") {
  const isAtEnd = log.scrollHeight - log.scrollTop - log.clientHeight < 20;
  const items = lines.map((line) => {
    const item = document.createElement("div");
    item.className = kind;
    item.textContent = line || "\u00a0";
    return item;
  });
  log.append(...items.slice(-MOST_LINES));
  while (log.childElementCount > MOST_LINES) log.firstElementChild.remove();
  if (isAtEnd || kind) log.scrollTop = log.scrollHeight; // else it is being read
}

const opened = new Promise((resolve) => { socket.onopen = resolve; });
const send = (text) => opened.then(() => socket.send(JSON.stringify(["stdin", text])));

function stop() {
  send(STOP);
  field.focus();
}

socket.onmessage = (event) => {
  if (typeof event.data === "string") {
    const [kind, text] = JSON.parse(event.data);
    if (kind === "ended") reason = text || "The game has ended.";
    return;
  }
  const lines = (rest + decoder.decode(event.data, { stream: true })).split("\n");
  rest = lines.pop();
  if (lines.length) show(lines);
};

socket.onclose = () => {
  show([...(rest ? [rest] : []), ...reason.trimEnd().split("\n")]);
  form.hidden = true;
  again.hidden = false;
  again.focus();
};

form.onsubmit = (event) => {
  event.preventDefault();
  const line = field.value;
  show([`> ${line}`], "typed");
  send(`${line}\n`);
  if (line && line !== commands.at(-1)) commands.push(line);
  commands.splice(0, commands.length - MOST_COMMANDS);
  place = commands.length;
  field.value = "";
};

field.onkeydown = (event) => {
  const step = { ArrowUp: -1, ArrowDown: 1 }[event.key];
  if (!step) return;
  event.preventDefault();
  place = Math.min(Math.max(place + step, 0), commands.length);
  field.value = commands[place] ?? "";
};

document.querySelector("#stop").onclick = stop;
again.onclick = () => location.reload();
window.addEventListener("keydown", (event) => {
  const isCopy = String(getSelection()) || field.selectionStart !== field.selectionEnd;
  if (event.key === "Escape" || (event.ctrlKey && event.key === "c" && !isCopy)) stop();
});
