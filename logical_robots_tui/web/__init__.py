"""The game in a browser: pages, and a websocket between each of them and a game of its own."""
