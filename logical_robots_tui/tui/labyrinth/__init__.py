"""The labyrinth on the screen: its view, camera, overlays and banners."""
