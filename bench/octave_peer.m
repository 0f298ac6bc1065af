% The batch evaluator's work in Octave, pose by pose, as people write it. Prints poses per second
% of processor time as JSON. Usage: octave-cli octave_peer.m FOLDER (as batch_bench wrote it)
1;

function [good, j] = delta_jacobian(m, t)
  v = t + m.platform - m.base;
  s = sum(v .* m.direction, 2);
  p = v - s .* m.direction;
  h = m.side .* sqrt(m.length .^ 2 - sum(p .* p, 2));
  q = s + h;
  good = all(q >= m.stroke(:, 1) & q <= m.stroke(:, 2));
  j = m.direction - p ./ h;
endfunction

function [good, j] = hexapod_jacobian(m, pose)
  c = cos(pose(4:6));
  s = sin(pose(4:6));
  r = [c(3), -s(3), 0; s(3), c(3), 0; 0, 0, 1] * [c(2), 0, s(2); 0, 1, 0; -s(2), 0, c(2)] ...
      * [1, 0, 0; 0, c(1), -s(1); 0, s(1), c(1)];
  arm = (m.platform - m.tool) * r';
  v = pose(1:3) + m.tool + arm - m.base;
  d = sqrt(sum(v .* v, 2));
  q = d - m.length;
  good = all(q >= m.stroke(:, 1) & q <= m.stroke(:, 2));
  u = v ./ d;
  j = [u, cross(arm, u, 2) / m.scale];
endfunction

% Poses per second, the best of three, and the mean of 1/kappa.
function [rate, average] = measure(jacobian, machine, poses)
  best = Inf;
  for repeat = 1:3
    start = cputime();
    total = 0;
    for i = 1:rows(poses)
      [good, j] = jacobian(machine, poses(i, :));
      if good
        total += 1 / cond(j);
      endif
    endfor
    best = min(best, cputime() - start);
  endfor
  rate = rows(poses) / best;
  average = total / rows(poses);
endfunction

function m = plain(machine)
  legs = machine.legs;
  m.base = [legs.base]';
  m.direction = [legs.direction]';
  m.platform = [legs.platform]';
  m.length = [legs.length]';
  m.side = [legs.side]';
  m.stroke = [legs.stroke]';
  m.tool = machine.tool';
  m.scale = machine.scale;
endfunction

folder = argv(){end};
machines = jsondecode(fileread([folder "/machines.json"]));
few = 2000;
poses = load([folder "/delta_poses.txt"])(1:few, :);
[rate, average] = measure(@delta_jacobian, plain(machines.delta), poses);
printf("{\"delta/condition/Octave loop\": {\"rate\": %.6g, \"mean_index\": %.12g},\n", rate, average);
poses = load([folder "/hexapod_poses.txt"])(1:few, :);
[rate, average] = measure(@hexapod_jacobian, plain(machines.hexapod), poses);
printf(" \"hexapod/condition/Octave loop\": {\"rate\": %.6g, \"mean_index\": %.12g}}\n", rate, average);
