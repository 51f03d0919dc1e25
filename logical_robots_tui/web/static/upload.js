"use strict";
// Files that are dropped on the page, or chosen in it, for the game.

const MOST_BYTES = 1_000_000; // the game says that a larger file is too large

function upload(file) {
  const reader = new FileReader();
  reader.onloadend = () => { // a folder can't be read, and counts as empty
    const content = (reader.result ?? "").split(",")[1] ?? "";
    socket.send(JSON.stringify(["upload", file.name, content]));
  };
  reader.readAsDataURL(file.slice(0, MOST_BYTES + 1));
}

window.addEventListener("load", () => {
  const dialog = document.querySelector("#upload");
  const input = dialog.querySelector("input");
  handlers.upload = () => {
    input.value = "";
    dialog.showModal();
    try {
      input.showPicker(); // some browsers want a key or a click in the dialog
    } catch (error) {
      if (error.name !== "NotAllowedError") throw error;
    }
  };
  input.onchange = () => {
    [...input.files].forEach(upload);
    dialog.close();
  };
  input.oncancel = (event) => {
    event.stopPropagation();
    dialog.close();
  };
  dialog.onclose = () => document.querySelector(".xterm-helper-textarea").focus();
});

const hasFiles = (event) => event.dataTransfer?.types.includes("Files");

window.addEventListener("dragover", (event) => {
  if (hasFiles(event)) event.preventDefault();
});

window.addEventListener("drop", (event) => {
  if (!hasFiles(event)) return;
  event.preventDefault();
  [...event.dataTransfer.files].forEach(upload);
});
