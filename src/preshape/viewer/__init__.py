"""The viewer in the browser: scenes, grasps, climbs and executed trials."""
