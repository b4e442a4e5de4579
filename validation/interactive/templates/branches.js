// Motions with unilateral contact, over the linear response of the pair's own law: an orbit is [branch, place].
const shownBranches = () => (now.law === sweep.own ? sweep.branches : []);

function orbitWords([b, i]) {
  const branch = sweep.branches[b];
  return [
    `${plain(branch.speed[i], 5)} rpm`, `${plain(branch.dte[i], 4)} µm peak to peak`, `largest tooth load ${plain(branch.load[i], 4)} N`,
    `largest multiplier ${plain(branch.radius[i], 4)}`, `repeats after ${branch.n} mesh cycle${branch.n > 1 ? "s" : ""}`,
    branch.stable[i] ? "stable" : "unstable",
  ];
}

// Two traces, stable and unstable; a piece between two orbits is stable where both are.
function branchTraces(colours) {
  const trace = (stable) => {
    const x = [], y = [], customdata = [];
    const add = (b, i) => {
      const orbit = i === null ? null : [b, i, ...orbitWords([b, i])];
      x.push(orbit && sweep.branches[b].speed[i]);
      y.push(orbit && sweep.branches[b].dte[i]);
      customdata.push(orbit);
    };
    shownBranches().forEach((branch, b) => {
      let open = false;
      for (let i = 0; i + 1 < branch.speed.length; i += 1) {
        const here = Boolean(branch.stable[i] && branch.stable[i + 1]) === stable;
        if (here && !open) add(b, i);
        if (here) add(b, i + 1);
        else if (open) add(b, null);
        open = here;
      }
      if (open) add(b, null);
    });
    const lines = [2, 3, 4, 5, 6, 7].map((k) => `%{customdata[${k}]}`).join("<br>");
    return {
      type: "scatter", mode: "lines", x, y, customdata, yaxis: "y", connectgaps: false,
      name: `unilateral contact, ${stable ? "stable" : "unstable"}`, showlegend: true,
      line: { color: colours.branch, width: stable ? 3.5 : 2, dash: stable ? "solid" : "dash" },
      hovertemplate: `${lines}<extra></extra>`,
    };
  };
  return [trace(true), trace(false)].filter(({ x }) => x.length);
}

// The orbit nearest to a speed, a stable one first; none where the speed is beyond all branches.
function orbitAt(speed) {
  let best = null, least = Infinity;
  shownBranches().forEach((branch, b) => {
    if (speed < Math.min(...branch.speed) || speed > Math.max(...branch.speed)) return;
    branch.speed.forEach((at, i) => {
      const away = Math.abs(at - speed) + (branch.stable[i] ? 0 : speed);
      if (away < least) [best, least] = [[b, i], away];
    });
  });
  return best;
}

// Its numbers.
function showOrbit(orbit) {
  element("motion-text").hidden = !shownBranches().length;
  element("motion-text").textContent = orbit
    ? `Motion with unilateral contact: ${orbitWords(orbit).join(", ")}.`
    : "No motion with unilateral contact was computed at the cursor's speed.";
}
