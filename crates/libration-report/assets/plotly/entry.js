// What the figures of Libration need of Plotly.js: lines, points and grids of values.
import Plotly from "plotly.js/lib/core";
import heatmap from "plotly.js/lib/heatmap";

Plotly.register([heatmap]);
globalThis.Plotly = Plotly;
