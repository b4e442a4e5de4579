// The charts appear only where scripts run; without them the page shows its tables.
document.documentElement.classList.add("scripted");
Promise.all([startStability(), startSweep()]).then(() => {
  document.documentElement.dataset.ready = "yes";
});
